// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "adit/study/surface_path.hpp"

namespace adit {

/// Surfaces that are farther apart than this (metres, along their normal) are not one surface to any sensor:
/// each of two sensors may be off by the worst accuracy that data sheets of rotating LiDARs state, 80 mm, in
/// opposite directions.
inline constexpr double kSurfaceTolerance = 0.16;

/// Where a stretch was laid in the end, and how well it fits there.
struct SurfaceFit {
  Pose T_there_here;       ///< Both in the world frame: carries the stretch to where it was laid.
  double differing = 1.0;  ///< Share of the stretch's rays that meet another surface there.
};

/// Lays the surface of a stretch over another place of the world: from `T_there_here` to the nearest
/// alignment, by point-to-plane steps against the mesh, then casts the stretch's rays from there. Stops early
/// where it will not fit, with the share found so far. The stretch has a sample at least.
[[nodiscard]] SurfaceFit fit_surface(const Raycaster& world, std::span<const SurfaceSample> stretch,
                                     const Pose& T_there_here);

}  // namespace adit

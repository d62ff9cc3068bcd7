// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The surfaces around a true path, by exact rays into the mesh of the world: what there is to see,
/// whatever sensor looks. For evaluation alone.
#pragma once

#include <array>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/simulation/raycaster.hpp"

namespace adit {

/// Rays of one viewpoint: rings of equal angles around the tunnel's axis; one ring looks straight at the
/// walls, one ahead and one back. Turned by 180 degrees about the vertical, the rays coincide with one
/// another.
///@{
inline constexpr std::size_t kRings = 3;
inline constexpr std::size_t kRaysPerRing = 24;
inline constexpr std::size_t kRays = kRings * kRaysPerRing;
///@}
/// Metres; what is farther counts as this far.
inline constexpr float kRayReach = 20.0F;

/// Of ray number `ray` in the frame of the viewpoint: x along the path, z up.
[[nodiscard]] const std::array<Eigen::Vector3f, kRays>& ray_directions();
/// The ray that takes the place of `ray` after half a turn about the vertical.
[[nodiscard]] std::size_t turned_ray(std::size_t ray);

/// The surface as one viewpoint sees it.
struct SurfaceSample {
  Pose T_world_view;  ///< Level; midway between the walls at the sides, so that the lane does not matter.
  std::array<float, kRays> ranges{};           ///< Metres, at most kRayReach.
  std::array<Eigen::Vector3f, kRays> normals;  ///< Of the surface, frame of the view; 0 where none is met.
};

/// One sample per metre of the path. A path shorter than a metre has none.
[[nodiscard]] std::vector<SurfaceSample> surface_along(const Raycaster& world, const Trajectory& truth);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Pipes and cables along the walls: part of the world, the same for all robots.
#pragma once

#include <cstdint>
#include <span>

#include "adit/core/records.hpp"
#include "adit/geometry/triangle_mesh.hpp"
#include "adit/simulation/raycaster.hpp"

namespace adit {

/// A pipe 1.8 m and two cables 2.2 and 2.35 m above the floor, on one wall, along a share of the paths
/// (T_world_base) in stretches of 40 m. They end where the wall steps back, and no path runs through them. A
/// tunnel that two paths share has them once.
[[nodiscard]] TriangleMesh wall_lines(const Raycaster& floor, std::span<const Trajectory> paths, double share,
                                      std::uint64_t seed);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Doors in the mouths of side passages, and machines that block the way on: open for one robot, closed for
/// another.
#pragma once

#include <cstdint>

#include "adit/core/records.hpp"
#include "adit/geometry/triangle_mesh.hpp"
#include "adit/simulation/raycaster.hpp"

namespace adit {

/// Closes a share of the openings beside a path (T_world_base): where the wall, 1.2 m above the floor, steps
/// back by 2.5 m or more over 1.5 to 8 m of the path, a leaf from floor to roof stands between its edges.
/// None stands in the way of the path itself.
[[nodiscard]] TriangleMesh closed_doors(const Raycaster& floor, const Trajectory& path, double share,
                                        std::uint64_t seed);

/// A machine as wide as the tunnel, with 0.3 m left on both sides, 4 m beyond the end of the path; empty
/// where the tunnel ends or opens before, or where it would stand on the path.
[[nodiscard]] TriangleMesh blocked_end(const Raycaster& floor, const Trajectory& path);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Walls that were worked on between two visits: fresh shotcrete, or a face that was widened.
#pragma once

#include <cstdint>

#include "adit/core/records.hpp"
#include "adit/geometry/triangle_mesh.hpp"

namespace adit {

/// How many stretches of the walls change, and by how much.
struct ChangedWalls {
  double per_km = 0.0;   ///< Stretches of 20 m along the path.
  double largest = 0.3;  ///< Metres; each stretch is drawn from a sixth of it to it, inwards or outwards.
};

/// The world with its walls and roof moved along their normals, on one side of the path (T_world_base) or all
/// around. The change fades out over 3 m at both ends and above the floor, which stays. Where walls come
/// nearer, at least 1.2 m stay free beside the path. Vertices are moved, none is added.
[[nodiscard]] TriangleMesh with_changed_walls(TriangleMesh world, const Trajectory& path,
                                              const ChangedWalls& changes, std::uint64_t seed);

}  // namespace adit

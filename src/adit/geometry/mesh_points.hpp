// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "adit/core/pose.hpp"
#include "adit/geometry/triangle_mesh.hpp"

namespace adit {

/// A point of a surface. It stands for the same area as every other one of its set.
struct MeshPoint {
  Vector3 point;   ///< Metres.
  Vector3 normal;  ///< Unit; the side follows the triangle's winding.
};

/// Points spread evenly over the mesh, one on each `spacing` x `spacing` metres of it: triangles are laid end
/// to end by their areas, a sample falls on every so much area, and where in its triangle is drawn at random
/// (always the same). Triangles without area have none. The mesh must pass `check_mesh`; `spacing` > 0.
[[nodiscard]] std::vector<MeshPoint> mesh_points(const TriangleMesh& mesh, double spacing);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A triangle mesh through points on surfaces.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "adit/geometry/triangle_mesh.hpp"

namespace adit {

/// The surface on which a weighted mean of the signed distances from the planes of near points is zero (Hoppe
/// et al., "Surface reconstruction from unorganized points", 1992; the weights of Kolluri, "Provably good
/// moving least squares", 2008, with a compact kernel), by naive surface nets (Gibson, "Constrained elastic
/// surface nets", 1998): a vertex in each cube of edge `cell_m` that the surface passes. Holes wider
/// than about two cells stay open, walls thinner than about one vanish; triangles face where the normals
/// point. `normals`: of unit length, one per point; points whose normal is zero are left out. The result has
/// no triangle where points are too few. The same points in the same order give the same mesh.
[[nodiscard]] TriangleMesh surface_mesh(const std::vector<Eigen::Vector3f>& points,
                                        const std::vector<Eigen::Vector3f>& normals, double cell_m);

}  // namespace adit

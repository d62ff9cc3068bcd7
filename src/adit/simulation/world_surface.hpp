// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// From solids to one mesh. Faces are cut exactly against the other solids instead of sampling a field on a
/// grid: concrete stays planar to rounding, and no grid leaves a texture that scan matching could lock onto.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "adit/geometry/triangle_mesh.hpp"
#include "adit/simulation/world_solids.hpp"

namespace adit {

/// The boundary of the union: every face without the parts inside another solid. Where faces of two solids
/// lie in one plane, the one of the earlier solid stays.
[[nodiscard]] std::vector<Face> boundary_of_union(std::span<const Solid> solids);

/// How the mesh is refined and displaced.
struct Surfacing {
  double max_edge =
      1.0;  ///< Longer edges are halved; edges within the plane z = 0 too unless the floor is flat.
  bool flat_floor = true;  ///< Whether the floor (z = 0) stays plane, so that large triangles do for it.
  std::function<Vector3(const Vector3&)> displaced;  ///< Maps points of the smooth surface to their place.
};

/// Merges equal corners, closes T-junctions, refines and displaces. Edges of the union end up in exactly two
/// triangles wherever the faces close.
[[nodiscard]] TriangleMesh surface_mesh(std::span<const Face> faces, const Surfacing& surfacing);

}  // namespace adit

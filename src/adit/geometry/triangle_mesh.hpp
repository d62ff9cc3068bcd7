// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "adit/core/result.hpp"

namespace adit {

/// A triangle soup with shared vertices, metres. A triangle's corners run counter-clockwise as seen from free
/// space, so that (b - a) x (c - a) points to where robots drive. The owner says in which frame.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;   ///< Some may be in no triangle.
  std::vector<Eigen::Vector3i> triangles;  ///< Indices into `vertices`.

  /// Whether there is no triangle; vertices do not count.
  [[nodiscard]] bool empty() const { return triangles.empty(); }
};

/// Fails when the mesh has no triangle, an index outside its vertices or a vertex that is not finite; the
/// message names the first of them.
Result<> check_mesh(const TriangleMesh& mesh);

/// The smallest axis-aligned box around all vertices; Eigen's empty box when there are none.
[[nodiscard]] Eigen::AlignedBox3f bounding_box(const TriangleMesh& mesh);

/// Adds the vertices and triangles of `part` to `mesh`; nothing is merged.
void append(TriangleMesh& mesh, const TriangleMesh& part);

/// Triangles meet in edges; in a closed surface every edge belongs to exactly two.
struct EdgeStatistics {
  std::size_t num_edges = 0;         ///< Pairs of vertices that are an edge of any triangle.
  std::size_t num_boundary = 0;      ///< Edges of one triangle: the rim of a hole.
  std::size_t num_over_shared = 0;   ///< Edges of three triangles or more.
  std::size_t num_inconsistent = 0;  ///< Edges that two triangles run through in the same direction.
};
/// Edges are told apart by vertex index: merge duplicate vertices first. The mesh must pass `check_mesh`.
[[nodiscard]] EdgeStatistics edge_statistics(const TriangleMesh& mesh);

}  // namespace adit

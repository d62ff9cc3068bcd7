// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/triangle_mesh.hpp"

#include <algorithm>
#include <utility>

#include "adit/core/format.hpp"

namespace adit {

Result<> check_mesh(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return fail("the mesh has no triangle: a surface is needed, not a point cloud");
  const auto num_vertices = static_cast<int>(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Eigen::Vector3i& triangle = mesh.triangles[i];
    if (triangle.minCoeff() < 0 || triangle.maxCoeff() >= num_vertices)
      return fail(format("triangle {} uses vertex {}, but there are only {}", i,
                         triangle.minCoeff() < 0 ? triangle.minCoeff() : triangle.maxCoeff(), num_vertices));
  }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!mesh.vertices[i].allFinite()) return fail(format("vertex {} is not finite", i));
  return {};
}

Eigen::AlignedBox3f bounding_box(const TriangleMesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& vertex : mesh.vertices) box.extend(vertex);
  return box;
}

void append(TriangleMesh& mesh, const TriangleMesh& part) {
  const auto shift = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
  mesh.triangles.reserve(mesh.triangles.size() + part.triangles.size());
  for (const Eigen::Vector3i& triangle : part.triangles)
    mesh.triangles.emplace_back(triangle + Eigen::Vector3i::Constant(shift));
}

EdgeStatistics edge_statistics(const TriangleMesh& mesh) {
  struct Edge {
    std::pair<int, int> ends;
    bool ascending;
  };
  std::vector<Edge> edges;
  edges.reserve(mesh.triangles.size() * 3);
  for (const Eigen::Vector3i& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) {
      const int a = t[k];
      const int b = t[(k + 1) % 3];
      edges.push_back({std::minmax(a, b), a < b});
    }
  std::ranges::sort(edges, {}, &Edge::ends);

  EdgeStatistics statistics;
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin;
    while (end < edges.size() && edges[end].ends == edges[begin].ends) ++end;
    ++statistics.num_edges;
    if (end - begin == 1) ++statistics.num_boundary;
    if (end - begin > 2) ++statistics.num_over_shared;
    if (end - begin == 2 && edges[begin].ascending == edges[begin + 1].ascending)
      ++statistics.num_inconsistent;
    begin = end;
  }
  return statistics;
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/triangle_mesh.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace adit {
namespace {

TriangleMesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}};
}

TEST(TriangleMesh, RefusesWhatIsNoSurface) {
  EXPECT_TRUE(check_mesh(tetrahedron()));
  EXPECT_NE(check_mesh({}).error().message.find("no triangle"), std::string::npos);
  TriangleMesh mesh = tetrahedron();
  mesh.triangles[2].y() = 4;
  EXPECT_NE(check_mesh(mesh).error().message.find("triangle 2 uses vertex 4"), std::string::npos);
  mesh.triangles[2].y() = -1;
  EXPECT_FALSE(check_mesh(mesh));
  mesh = tetrahedron();
  mesh.vertices[3].z() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(check_mesh(mesh).error().message.find("vertex 3"), std::string::npos);
}

TEST(TriangleMesh, BoundingBoxHoldsAllVertices) {
  EXPECT_TRUE(bounding_box({}).isEmpty());
  const Eigen::AlignedBox3f box = bounding_box(tetrahedron());
  EXPECT_EQ(box.min(), Eigen::Vector3f(0, 0, 0));
  EXPECT_EQ(box.max(), Eigen::Vector3f(1, 1, 1));
}

TEST(TriangleMesh, AppendShiftsIndices) {
  TriangleMesh mesh = tetrahedron();
  append(mesh, tetrahedron());
  EXPECT_TRUE(check_mesh(mesh));
  EXPECT_EQ(mesh.triangles[4], Eigen::Vector3i(4, 6, 5));
  EXPECT_EQ(edge_statistics(mesh).num_edges, 12U);
}

TEST(TriangleMesh, EdgeStatisticsFindHolesAndTurnedTriangles) {
  TriangleMesh mesh = tetrahedron();
  EdgeStatistics closed = edge_statistics(mesh);
  EXPECT_EQ(closed.num_edges, 6U);
  EXPECT_EQ(closed.num_boundary + closed.num_over_shared + closed.num_inconsistent, 0U);

  std::swap(mesh.triangles[1].x(), mesh.triangles[1].y());
  EXPECT_EQ(edge_statistics(mesh).num_inconsistent, 3U);
  mesh.triangles.pop_back();
  EXPECT_EQ(edge_statistics(mesh).num_boundary, 3U);
  mesh = tetrahedron();
  mesh.triangles.push_back(mesh.triangles.front());
  EXPECT_EQ(edge_statistics(mesh).num_over_shared, 3U);
}

}  // namespace
}  // namespace adit

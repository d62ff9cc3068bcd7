// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/mesh_points.hpp"

#include <gtest/gtest.h>

#include "support/meshes.hpp"

namespace adit {
namespace {

TEST(MeshPoints, EachStandsForTheSameAreaHoweverTheSurfaceIsCut) {
  const auto flat = [](double, double) { return 1.5; };
  const Eigen::AlignedBox2d area(Eigen::Vector2d(0, 0), Eigen::Vector2d(20, 10));
  for (const double step : {10.0, 1.0, 0.25}) {
    const std::vector<MeshPoint> points = mesh_points(test::floor_of(area, step, flat), 0.2);
    EXPECT_NEAR(static_cast<double>(points.size()), 200.0 / 0.04, 1.0) << step;
    double left = 0;
    for (const MeshPoint& p : points) {
      EXPECT_NEAR(p.point.z(), 1.5, 1e-6);
      EXPECT_NEAR(p.normal.z(), 1.0, 1e-6);
      EXPECT_TRUE(area.contains(Eigen::Vector2d(p.point.head<2>()))) << p.point.transpose();
      left += p.point.x() < 5.0 ? 1 : 0;
    }
    EXPECT_NEAR(left / static_cast<double>(points.size()), 0.25, 0.03) << step;
  }
}

TEST(MeshPoints, AreTheSameEveryTimeAndNoneWhereThereIsNoArea) {
  const TriangleMesh room = test::room({0, 0, 0}, {4, 3, 2});
  const auto a = mesh_points(room, 0.5);
  const auto b = mesh_points(room, 0.5);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].point, b[i].point);
  TriangleMesh line;
  line.vertices = {{0, 0, 0}, {9, 0, 0}, {4, 0, 0}};
  line.triangles = {{0, 1, 2}};
  EXPECT_TRUE(mesh_points(line, 0.1).empty());
}

}  // namespace
}  // namespace adit

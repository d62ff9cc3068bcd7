// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/surface_mesh.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr float kRadius = 2.0F;  // metres

struct Seen {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;
};

// On a sphere about (0.3, 0.1, -0.2), seen from inside, with that noise of the points.
const Eigen::Vector3f kCentre(0.3F, 0.1F, -0.2F);
Seen sphere(std::size_t num, double noise) {
  Rng rng(1);
  Seen out;
  for (std::size_t i = 0; i < num; ++i) {
    // A spiral with equal areas between its turns.
    const double z = 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(num);
    const double angle = std::numbers::pi * (1.0 + std::sqrt(5.0)) * static_cast<double>(i);
    const double r = std::sqrt(1.0 - z * z);
    const Eigen::Vector3f outwards(static_cast<float>(r * std::cos(angle)),
                                   static_cast<float>(r * std::sin(angle)), static_cast<float>(z));
    out.points.emplace_back(kCentre + (kRadius + static_cast<float>(noise * rng.normal())) * outwards);
    out.normals.emplace_back(-outwards);
  }
  return out;
}

Eigen::Vector3f doubled_area(const TriangleMesh& mesh, const Eigen::Vector3i& triangle) {
  const auto corner = [&](Eigen::Index i) { return mesh.vertices[static_cast<std::size_t>(triangle[i])]; };
  return (corner(1) - corner(0)).cross(corner(2) - corner(0));
}

TEST(SurfaceMesh, ASphereIsClosedAndFacesItsInside) {
  for (const double noise : {0.0, 0.01}) {
    const Seen ball = sphere(20000, noise);
    const TriangleMesh mesh = surface_mesh(ball.points, ball.normals, 0.1);
    ASSERT_TRUE(check_mesh(mesh));
    const EdgeStatistics edges = edge_statistics(mesh);
    EXPECT_EQ(edges.num_boundary, 0U);
    EXPECT_EQ(edges.num_over_shared, 0U);
    EXPECT_EQ(edges.num_inconsistent, 0U);
    double area = 0.0;
    for (const Eigen::Vector3i& triangle : mesh.triangles) {
      const Eigen::Vector3f facing = doubled_area(mesh, triangle);
      area += 0.5 * static_cast<double>(facing.norm());
      EXPECT_LT(facing.dot(mesh.vertices[static_cast<std::size_t>(triangle[0])] - kCentre), 0.0F);
    }
    EXPECT_NEAR(area, 4.0 * std::numbers::pi * kRadius * kRadius, 0.02 * area);
    for (const Eigen::Vector3f& vertex : mesh.vertices)
      EXPECT_NEAR((vertex - kCentre).norm(), kRadius, 0.01 + noise);
  }
}

TEST(SurfaceMesh, HolesStayOpenAndPointsWithoutNormalsSayNothing) {
  Seen ball = sphere(20000, 0.0);
  for (std::size_t i = 0; i < ball.points.size(); ++i)
    if (ball.points[i].x() > kCentre.x() + 1.5F) ball.normals[i].setZero();
  const TriangleMesh mesh = surface_mesh(ball.points, ball.normals, 0.1);
  EXPECT_GT(edge_statistics(mesh).num_boundary, 20U);
  for (const Eigen::Vector3f& vertex : mesh.vertices) EXPECT_LT(vertex.x(), kCentre.x() + 1.7F);
}

TEST(SurfaceMesh, OfNothingIsEmpty) { EXPECT_TRUE(surface_mesh({}, {}, 0.1).empty()); }

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/normals.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

using Points = std::vector<Eigen::Vector3f>;

Points plane_points(const Eigen::Vector3d& normal, double offset, std::size_t n) {
  Rng rng(17);
  const Eigen::Vector3d u = normal.unitOrthogonal();
  const Eigen::Vector3d v = normal.cross(u);
  Points points;
  for (std::size_t i = 0; i < n; ++i) {
    points.push_back(
        (offset * normal + rng.uniform(-2.0, 2.0) * u + rng.uniform(-2.0, 2.0) * v).cast<float>());
  }
  return points;
}

TEST(Normals, OfAPlaneStandOnItAndFaceTheSensor) {
  const Eigen::Vector3d normal = Eigen::Vector3d(1.0, -2.0, 3.0).normalized();
  const Points points = plane_points(normal, 5.0, 500);
  for (const Eigen::Vector3f& n : estimate_normals(points, 1.0F)) {
    EXPECT_NEAR(n.norm(), 1.0F, 1e-5F);
    EXPECT_GT(-normal.cast<float>().dot(n), 0.9999F);
  }
}

TEST(Normals, AgreeWithADoublePrecisionOracle) {
  Rng rng(4);
  Points points;
  for (int i = 0; i < 300; ++i) {  // far from the origin, where floats are coarse
    points.push_back(
        Eigen::Vector3d(90.0 + rng.normal(), 40.0 + rng.normal(), 0.2 * rng.normal()).cast<float>());
  }
  const float radius = 0.8F;
  const auto surface = estimate_surface(points, find_pairs_within(points, 1.2F), radius);
  for (std::size_t i = 0; i < points.size(); ++i) {
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    std::vector<Eigen::Vector3d> near;
    for (const Eigen::Vector3f& p : points) {
      if ((p - points[i]).squaredNorm() <= radius * radius) near.push_back(p.cast<double>());
    }
    for (const auto& p : near) mean += p / static_cast<double>(near.size());
    for (const auto& p : near) scatter += (p - mean) * (p - mean).transpose();
    EXPECT_EQ(surface[i].valid, near.size() >= 4);  // itself and 3 neighbours
    if (near.size() < 8) continue;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter);
    const auto& l = solver.eigenvalues();
    EXPECT_NEAR(surface[i].linearity, (l[2] - l[1]) / l[2], 1e-3);
    EXPECT_NEAR(surface[i].planarity, (l[1] - l[0]) / l[2], 1e-3);
    if (l[1] - l[0] < 0.05 * l[2]) continue;  // the normal itself is not well defined
    EXPECT_GT(std::abs(solver.eigenvectors().col(0).dot(surface[i].normal.cast<double>())), 0.999);
  }
}

TEST(Normals, AreNotMadeUpWherePointsHaveNoSurface) {
  Points line;
  for (int i = 0; i < 50; ++i) line.emplace_back(1.0F, 0.05F * static_cast<float>(i), 0.0F);
  for (const Eigen::Vector3f& n : estimate_normals(line, 1.0F)) EXPECT_TRUE(n.isZero());
  for (const Eigen::Vector3f& n : estimate_normals(Points(10, {1.0F, 1.0F, 1.0F}), 1.0F))
    EXPECT_TRUE(n.isZero());
  for (const Eigen::Vector3f& n :
       estimate_normals({{0.0F, 0.0F, 1.0F}, {1.0F, 0.0F, 1.0F}, {0.0F, 1.0F, 1.0F}}, 2.0F)) {
    EXPECT_TRUE(n.isZero());  // two neighbours each
  }
  Points with_nan = plane_points(Eigen::Vector3d::UnitZ(), 3.0, 100);
  with_nan[5].x() = std::nanf("");
  EXPECT_TRUE(estimate_normals(with_nan, 1.0F)[5].isZero());
  EXPECT_TRUE(estimate_normals({}, 1.0F).empty());
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/icp_refine.hpp"

#include <gtest/gtest.h>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

/// Points on three walls of a corner, with their true normals.
OrientedPoints corner(std::size_t n, std::uint64_t seed) {
  Rng rng(seed);
  OrientedPoints out;
  for (std::size_t k = 0; k < n; ++k) {
    const int wall = static_cast<int>(k % 3);
    Vector3 p(rng.uniform(0.0, 6.0), rng.uniform(0.0, 6.0), rng.uniform(0.0, 6.0));
    p[wall] = 0.0;
    out.points.push_back(p.cast<float>());
    out.normals.push_back(Eigen::Vector3f::Unit(wall));
  }
  return out;
}

TEST(RefinePointToPlane, RecoversThePoseOfACorner) {
  const OrientedPoints a = corner(3000, 2);
  const OrientedPoints b = corner(3000, 3);
  const PointGrid grid(a.points, 1.0);
  const Pose guess = Pose::exp((Vector6() << 0.15, -0.1, 0.12, 0.02, -0.03, 0.02).finished());
  const Pose refined = refine_point_to_plane(a, grid, b, guess, {});
  EXPECT_LT(refined.translation().norm(), 1e-3);
  EXPECT_LT(refined.angle(), 1e-3);
}

TEST(RefinePointToPlane, LeavesOpenDirectionsAlone) {
  OrientedPoints a = corner(3000, 2);
  for (std::size_t k = 0; k < a.size(); ++k) {  // a floor alone
    a.points[k].z() = 0.0F;
    a.normals[k] = Eigen::Vector3f::UnitZ();
  }
  const Pose guess = Pose::translation_of(0.3, 0.2, 0.1);
  const Pose refined = refine_point_to_plane(a, PointGrid(a.points, 1.0), a, guess, {});
  EXPECT_NEAR(refined.translation().x(), 0.3, 1e-3);
  EXPECT_NEAR(refined.translation().y(), 0.2, 1e-3);
  EXPECT_NEAR(refined.translation().z(), 0.0, 1e-3);
}

TEST(RefinePointToPlane, WithoutNeighborsReturnsTheGuess) {
  const OrientedPoints a = corner(100, 2);
  const Pose guess = Pose::translation_of(500.0, 0.0, 0.0);
  EXPECT_EQ(refine_point_to_plane(a, PointGrid(a.points, 1.0), a, guess, {}).matrix(), guess.matrix());
  EXPECT_TRUE(associate(PointGrid(), a, Pose(), 1.0).empty());
}

}  // namespace
}  // namespace adit

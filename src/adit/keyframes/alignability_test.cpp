// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/keyframes/alignability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/tubes.hpp"

namespace adit {
namespace {

TEST(Alignability, ARoomIsAThirdAndATubeIsOpenAlongItsAxis) {
  const std::vector<Eigen::Vector3f> room = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},
                                             {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
  EXPECT_TRUE(alignability(room)->eigenvalues.isApproxToConstant(1.0 / 3.0, 1e-9));
  const std::vector<Eigen::Vector3f> tube = {{0, 1, 0}, {0, 0, 1}, {0, -1, 0}, {0, 0.6F, 0.8F}};
  EXPECT_NEAR(alignability(tube)->weakest(), 0.0, 1e-12);
  EXPECT_NEAR(std::abs(alignability(tube)->weak_axis().x()), 1.0, 1e-9);
}

TEST(Alignability, OfClouds) {
  const Alignability tube = alignability_of_points(straight_tube().points).value();
  const Alignability open = alignability_of_points(junction().points).value();
  EXPECT_LT(tube.weakest(), 0.01);
  EXPECT_GT(open.weakest(), 3.0 * tube.weakest());
  EXPECT_GT(open.weakest(), 0.05);
  EXPECT_NEAR(std::abs(tube.weak_axis().dot(Vector3(std::cos(0.3), std::sin(0.3), 0))), 1.0, 0.01);
  EXPECT_NEAR(open.eigenvalues.sum(), 1.0, 1e-6);
}

TEST(Alignability, NothingWithoutSurface) {
  EXPECT_FALSE(alignability({}));
  EXPECT_FALSE(alignability_of_points({}));
  const std::vector<Eigen::Vector3f> none = {{0, 0, 0}, {std::nanf(""), 0, 0}};
  EXPECT_FALSE(alignability(none));
  const std::vector<Eigen::Vector3f> apart = {{0, 0, 0}, {50, 0, 0}, {0, 50, 0}};
  EXPECT_FALSE(alignability_of_points(apart));
}

}  // namespace
}  // namespace adit

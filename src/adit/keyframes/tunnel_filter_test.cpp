// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/keyframes/tunnel_filter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "adit/core/check.hpp"
#include "support/tubes.hpp"

namespace adit {
namespace {

// Which points of a flat wall are hull vertices hangs on the rounding of their coordinates, and with them the
// axes of the box turn a little: hence the metre in these tests.
TEST(TunnelFilter, AStraightTubeIsAboutAsWideAsItself) {
  const TunnelVerdict verdict = tunnel_filter(straight_tube(), {}).value();
  EXPECT_TRUE(verdict.tunnel_like);
  EXPECT_NEAR(verdict.extents.y(), 10.0, 1.5);
  EXPECT_NEAR(verdict.extents.z(), 7.0, 1.5);
  EXPECT_NEAR(verdict.extents.x(), 60.0, 1.0);  // The crop.
}

TEST(TunnelFilter, AJunctionIsNot) {
  const TunnelVerdict verdict = tunnel_filter(junction(), {}).value();
  EXPECT_FALSE(verdict.tunnel_like);
  EXPECT_GT(verdict.extents.y(), 25.0);
}

TEST(TunnelFilter, TheVerdictDoesNotTurnWithTheRobot) {
  const TunnelVerdict straight = tunnel_filter(junction(), {}).value();
  for (const double yaw : {0.7, 2.0, -2.9}) {
    const TunnelVerdict turned = tunnel_filter(transformed(Pose::planar(0, 0, yaw), junction()), {}).value();
    EXPECT_LT((turned.extents - straight.extents).norm(), 1.0);
    EXPECT_FALSE(turned.tunnel_like);
  }
}

TEST(TunnelFilter, ZeroRangeKeepsEveryPoint) {
  TunnelFilterConfig config;
  config.max_range_m = 0.0;
  EXPECT_NEAR(tunnel_filter(straight_tube(), config)->extents.x(), 100.0, 1.0);
}

TEST(TunnelFilter, EmptyCloudsAreErrorsThatSayWhy) {
  EXPECT_FALSE(tunnel_filter({}, {}));
  PointCloud far;
  far.points = {{100, 0, 0}, {std::nanf(""), 0, 0}};
  const Result<TunnelVerdict> verdict = tunnel_filter(far, {});
  ASSERT_FALSE(verdict);
  EXPECT_NE(verdict.error().message.find("max_range_m"), std::string::npos);
  EXPECT_TRUE(tunnel_filter(far, {.max_range_m = 0.0})->tunnel_like);  // One point has no width.
  EXPECT_THROW(static_cast<void>(tunnel_filter(far, {.width_threshold_m = -1.0})), ContractViolation);
}

}  // namespace
}  // namespace adit

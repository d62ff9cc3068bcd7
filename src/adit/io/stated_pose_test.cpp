// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/stated_pose.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/files.hpp"

namespace adit {
namespace {

TEST(StatedPose, IsKeptToTheLastBitOrMadeOfLengthOne) {
  const Eigen::Quaterniond exact = Eigen::Quaterniond(0.3, -0.5, 0.2, 0.7).normalized();
  const Result<Pose> kept = stated_pose({1.0, 2.0, 3.0}, exact);
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->rotation().coeffs(), exact.coeffs());
  EXPECT_EQ(kept->translation(), Vector3(1.0, 2.0, 3.0));
  const Result<Pose> rounded = stated_pose(Vector3::Zero(), {0.71, 0.0, 0.0, 0.70});
  ASSERT_TRUE(rounded);
  EXPECT_NEAR(rounded->rotation().norm(), 1.0, 1e-15);
}

TEST(StatedPose, SaysWhatIsNoPose) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_ERROR(stated_pose(Vector3::Zero(), {2.0, 0.0, 0.0, 0.0}), "norm 2, not 1; check the order");
  EXPECT_ERROR(stated_pose(Vector3::Zero(), {0.0, 0.0, 0.0, 0.0}), "norm 0, not 1");
  EXPECT_ERROR(stated_pose(Vector3::Zero(), {kNan, 0.0, 0.0, 0.0}), "norm nan, not 1");
  EXPECT_ERROR(stated_pose(Vector3::Zero(), {1.0, 1e-4, 0.0, 0.0}, 1e-9), "not 1");
  EXPECT_ERROR(stated_pose({0.0, 1e12, 0.0}, Eigen::Quaterniond::Identity()),
               "1000000000000 is not a coordinate");
  EXPECT_ERROR(stated_pose({kNan, 0.0, 0.0}, Eigen::Quaterniond::Identity()), "not a coordinate");
}

}  // namespace
}  // namespace adit

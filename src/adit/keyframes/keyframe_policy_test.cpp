// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/keyframes/keyframe_policy.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "adit/core/check.hpp"

namespace adit {
namespace {

OdometryStep step_at(double seconds, const Pose& T_odom_base, StepStatus status = StepStatus::ok) {
  OdometryStep step;
  step.stamp = Stamp{} + from_seconds(seconds);
  step.T_odom_base = T_odom_base;
  step.status = status;
  return step;
}

KeyframePolicyConfig policy_of(KeyframeRule rule) {
  KeyframePolicyConfig config;
  config.policy = rule;
  return config;
}

TEST(KeyframePolicy, DistanceTakesAStraightTrackEveryHalfMetre) {
  KeyframePolicy policy({});
  int num_keyframes = 0;
  for (int i = 0; i <= 800; ++i) {  // 100 m in steps of 1/8 m, which add up without rounding.
    const bool accepted = policy.accepts(step_at(0.1 * i, Pose::translation_of(0.125 * i, 0, 0)));
    EXPECT_EQ(accepted, i % 4 == 0) << i;
    num_keyframes += accepted ? 1 : 0;
  }
  EXPECT_EQ(num_keyframes, 201);
}

TEST(KeyframePolicy, DistanceIsMeasuredInSpaceFromTheLastKeyframe) {
  KeyframePolicy policy({});
  EXPECT_TRUE(policy.accepts(step_at(0, Pose::translation_of(5, 5, 5))));
  EXPECT_FALSE(
      policy.accepts(step_at(1, Pose::translation_of(5.3, 5, 5.3))));         // Shaking without getting away
  EXPECT_FALSE(policy.accepts(step_at(2, Pose::translation_of(4.8, 5, 5))));  // adds nothing up.
  EXPECT_FALSE(policy.accepts(step_at(3, Pose::planar(5, 5, 3.0, 5))));       // Nor does turning on the spot.
  EXPECT_TRUE(policy.accepts(step_at(4, Pose::translation_of(5.3, 5.3, 5.3))));
  EXPECT_FALSE(policy.accepts(step_at(5, Pose::translation_of(5, 5.3, 5.3))));
}

TEST(KeyframePolicy, DistanceAngleAlsoTakesTurns) {
  KeyframePolicy policy(policy_of(KeyframeRule::distance_angle));
  const double degree = M_PI / 180.0;
  EXPECT_TRUE(policy.accepts(step_at(0, Pose::planar(0, 0, 179.0 * degree))));
  EXPECT_FALSE(
      policy.accepts(step_at(1, Pose::planar(0, 0, 188.9 * degree))));  // Over the +-180 degree seam.
  EXPECT_TRUE(policy.accepts(step_at(2, Pose::planar(0, 0, 189.1 * degree))));
  EXPECT_FALSE(policy.accepts(step_at(3, Pose::planar(0.4, 0, 189.1 * degree))));
  EXPECT_TRUE(policy.accepts(step_at(4, Pose::planar(0.5, 0, 189.1 * degree))));
}

TEST(KeyframePolicy, TimeCountsFromTheLastKeyframe) {
  KeyframePolicy policy(policy_of(KeyframeRule::time));
  EXPECT_TRUE(policy.accepts(step_at(1e9, {})));
  EXPECT_FALSE(policy.accepts(step_at(1e9 + 0.999, Pose::translation_of(50, 0, 0))));
  EXPECT_TRUE(policy.accepts(step_at(1e9 + 1.0, {})));
  EXPECT_TRUE(policy.accepts(step_at(1e9 + 2.5, {})));
  EXPECT_FALSE(policy.accepts(step_at(1e9 + 3.0, {})));
}

TEST(KeyframePolicy, StepsThatWereNotRegisteredAreNeverKeyframes) {
  KeyframePolicy policy({});
  EXPECT_FALSE(policy.accepts(step_at(0, {}, StepStatus::too_few_points)));
  EXPECT_FALSE(policy.accepts(step_at(1, {}, StepStatus::diverged)));
  EXPECT_TRUE(policy.accepts(step_at(2, {}, StepStatus::no_map)));
  EXPECT_FALSE(policy.accepts(step_at(3, Pose::translation_of(9, 0, 0), StepStatus::diverged)));
  // A refused step leaves no trace: the next is still measured from the keyframe at 0.
  EXPECT_TRUE(policy.accepts(step_at(4, Pose::translation_of(9, 0, 0), StepStatus::degenerate)));
}

TEST(KeyframePolicy, RefusesBadConfigurations) {
  KeyframePolicyConfig config;
  config.distance_m = -1.0;
  EXPECT_THROW(KeyframePolicy{config}, ContractViolation);
}

}  // namespace
}  // namespace adit

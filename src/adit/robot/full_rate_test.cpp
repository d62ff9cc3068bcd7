// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/full_rate.hpp"

#include <gtest/gtest.h>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

/// 21 scans, every fifth of them from the third on a keyframe, that drift from where they truly are.
struct Drive {
  RobotMap map;
  Trajectory truth;
  std::vector<Pose> T_world_keyframe;

  explicit Drive(const Vector6& drift_a_scan) {
    Rng rng(5);
    Pose T_odom;
    Pose T_world = Pose::planar(3.0, -2.0, 1.0);
    for (int i = 0; i < 21; ++i) {
      const Stamp stamp{i * 100'000'000LL};
      map.odometry.push_back({stamp, T_odom});
      truth.push_back({stamp, T_world});
      if (i % 5 == 2) {
        Keyframe keyframe;
        keyframe.stamp = stamp;
        keyframe.T_odom_base = T_odom;
        map.keyframes.push_back(keyframe);
        T_world_keyframe.push_back(T_world);
      }
      Vector6 step = 0.02 * Vector6::NullaryExpr([&](auto) { return rng.normal(); });
      step[0] += 0.3;
      T_world = T_world * Pose::exp(step);
      T_odom = T_odom * Pose::exp(step) * Pose::exp(drift_a_scan);
    }
  }
};

TEST(AtEveryScan, IsTheOdometryWhereThatDoesNotDrift) {
  const Drive drive(Vector6::Zero());
  const Trajectory poses = at_every_scan(drive.map, drive.T_world_keyframe);
  ASSERT_EQ(poses.size(), drive.truth.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].stamp, drive.truth[i].stamp);
    EXPECT_LT((poses[i].T_world_body.inverse() * drive.truth[i].T_world_body).log().norm(), 1e-9) << i;
  }
}

TEST(AtEveryScan, MeetsEveryKeyframeAndBendsEvenlyInBetween) {
  const Vector6 drift = (Vector6() << 0.02, -0.01, 0.01, 0.001, 0.002, -0.003).finished();
  const Drive drive(drift);
  const Trajectory poses = at_every_scan(drive.map, drive.T_world_keyframe);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double off = (poses[i].T_world_body.inverse() * drive.truth[i].T_world_body).log().norm();
    if (i < 2 || i > 17) continue;
    EXPECT_LT(off, i % 5 == 2 ? 1e-9 : 0.25 * drift.norm()) << i << ": of up to 4 times the drift";
  }
}

TEST(AtEveryScan, NothingWithoutKeyframes) {
  Drive drive(Vector6::Zero());
  drive.map.keyframes.clear();
  EXPECT_TRUE(at_every_scan(drive.map, {}).empty());
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/shared_stretch.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace adit {
namespace {

/// Straight from `from` to `to`, a pose every centimetre, one per millisecond.
Trajectory drive(const Vector3& from, const Vector3& to) {
  Trajectory trajectory;
  const double length = (to - from).norm();
  const auto num = static_cast<std::int64_t>(length / 0.01);
  for (std::int64_t i = 0; i <= num; ++i) {
    const Vector3 p = from + (to - from) * (static_cast<double>(i) / static_cast<double>(num));
    trajectory.push_back({Stamp{i * 1'000'000}, Pose::translation_of(p.x(), p.y(), p.z())});
  }
  return trajectory;
}

TEST(SharedStretch, OverlapIsMeasuredWhicheverWayRobotsDrive) {
  const Trajectory a = drive({0, 0, 0}, {100, 0, 0});
  Trajectory b = drive({60, 1, 0}, {160, 1, 0});
  // The reach adds what lies just beyond the end of the other's path.
  EXPECT_NEAR(shared_stretch_m(a, b), 40.0 + 4.0, 1.0);
  b = drive({160, 1, 0}, {60, 1, 0});
  EXPECT_NEAR(shared_stretch_m(a, b), 44.0, 1.0);
  EXPECT_DOUBLE_EQ(shared_stretch_m(a, b), shared_stretch_m(b, a));
}

TEST(SharedStretch, ParallelTunnelsAndOtherLevelsShareNothing) {
  const Trajectory a = drive({0, 0, 0}, {100, 0, 0});
  EXPECT_EQ(shared_stretch_m(a, drive({0, 12, 0}, {100, 12, 0})), 0.0);
  EXPECT_EQ(shared_stretch_m(a, drive({0, 0, 6}, {100, 0, 6})), 0.0);
  EXPECT_EQ(shared_stretch_m(a, {}), 0.0);
}

TEST(SharedStretch, ACrossingIsShort) {
  const Trajectory a = drive({0, 0, 0}, {100, 0, 0});
  EXPECT_LT(shared_stretch_m(a, drive({50, -50, 0}, {50, 50, 0})), 10.0);
}

TEST(SharedStretch, WhoDrovePastTwiceDoesNotShareMore) {
  const Trajectory a = drive({0, 0, 0}, {100, 0, 0});
  Trajectory b = drive({80, 0, 0}, {120, 0, 0});
  const double once = shared_stretch_m(a, b);
  Trajectory back = drive({120, 0, 0}, {80, 0, 0});
  const Duration later = b.back().stamp - back.front().stamp + std::chrono::milliseconds(1);
  for (StampedPose& pose : back) b.push_back({pose.stamp + later, pose.T_world_body});
  EXPECT_NEAR(shared_stretch_m(a, b), once, 1.0);
}

TEST(SharedStretch, GroupsAreChainsOfSharingPairs) {
  // 0-2 and 2-3 share, 1 is alone.
  std::vector<std::vector<double>> shared(4, std::vector<double>(4, 0.0));
  shared[0][2] = shared[2][0] = 30.0;
  shared[2][3] = shared[3][2] = 50.0;
  shared[0][1] = shared[1][0] = 5.0;
  EXPECT_EQ(groups_sharing(shared, 25.0), (std::vector<std::vector<std::size_t>>{{0, 2, 3}, {1}}));
  EXPECT_EQ(groups_sharing(shared, 1.0).size(), 1U);
  EXPECT_TRUE(groups_sharing({}, 25.0).empty());
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/submap.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <stdexcept>

namespace adit {
namespace {

// A keyframe every half metre along x, then back; each saw one point, at the same place of the world: 5 m to
// the left of the origin.
RobotMap there_and_back(int num) {
  RobotMap map;
  for (int k = 0; k < 2 * num; ++k) {
    const double x = 0.5 * (k < num ? k : 2 * num - 1 - k);
    Keyframe keyframe;
    keyframe.id.index = static_cast<std::uint32_t>(k);
    keyframe.T_odom_base = Pose::planar(x, 0.0, k < num ? 0.0 : 3.14159265358979);
    PointCloud cloud;
    cloud.points = {(keyframe.T_odom_base.inverse() * Vector3(0.0, 5.0, 0.0)).cast<float>()};
    keyframe.cloud = std::make_shared<const PointCloud>(cloud);
    map.keyframes.push_back(keyframe);
  }
  return map;
}

TEST(Submap, BringsTheKeyframesWithinReachTogether) {
  const RobotMap map = there_and_back(100);
  const PointCloud cloud = submap(map, 20, {.reach_m = 6.0, .step_m = 2.0, .radius_m = 30.0});
  EXPECT_EQ(cloud.points.size(), 7U) << "one every two metres, to both sides";
  for (const Eigen::Vector3f& p : cloud.points)
    EXPECT_LT((p - Eigen::Vector3f(-10.0F, 5.0F, 0.0F)).norm(), 1e-4F);
}

TEST(Submap, ReachCountsAlongThePath) {
  // The way back passes the same spots, which are far away along the path.
  const RobotMap map = there_and_back(100);
  EXPECT_EQ(submap(map, 5, {.reach_m = 6.0, .step_m = 2.0}).points.size(), 5U)
      << "the path begins 2.5 m before";
  EXPECT_EQ(submap(map, 99, {.reach_m = 6.0, .step_m = 2.0, .radius_m = 100.0}).points.size(), 7U)
      << "around the turning point both ways are near";
}

TEST(Submap, LeavesOutWhatIsFar) {
  const RobotMap map = there_and_back(100);
  EXPECT_TRUE(submap(map, 80, {}).points.empty());
  EXPECT_FALSE(submap(map, 80, {.radius_m = 100.0}).points.empty());
}

TEST(Submap, WithoutReachIsTheKeyframeAsItIs) {
  const RobotMap map = there_and_back(100);
  EXPECT_EQ(submap(map, 80, {.reach_m = 0.0}).points, map.keyframes[80].cloud->points);
  EXPECT_THROW((void)submap(map, 200, {}), std::out_of_range);
}

}  // namespace
}  // namespace adit

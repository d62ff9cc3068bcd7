// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/frame_tree.hpp"

#include <gtest/gtest.h>

#include "support/files.hpp"

namespace adit {
namespace {

const Pose kSensor = Pose::planar(0.2, 0.1, 0.7, 0.8);
const Pose kLidar(Eigen::Quaterniond(0, 0, 0, 1), Vector3(0, 0, 0.036));

/// base_footprint -> base_link -> os_sensor -> {os_lidar, os_imu}, and a camera elsewhere.
FrameTree ouster() {
  FrameTree tree;
  tree.add("os_sensor", "/os_lidar", kLidar);
  tree.add("/os_sensor", "os_imu", Pose::translation_of(0, 0, 0.01));
  tree.add("/base_link", "/os_sensor", kSensor);
  tree.add("base_footprint", "base_link", Pose::translation_of(0, 0, 0.3));
  tree.add("table", "camera", Pose());
  return tree;
}

double apart(const Pose& a, const Pose& b) { return (a.inverse() * b).log().norm(); }

TEST(FrameTree, FollowsLinksOfAnyDepthInBothDirections) {
  const FrameTree tree = ouster();
  const auto chain = tree.between("base_link", "os_lidar");
  ASSERT_TRUE(chain) << chain.error().message;
  EXPECT_LT(apart(chain->T_a_b, kSensor * kLidar), 1e-14);
  EXPECT_EQ(chain->frames, (std::vector<std::string>{"base_link", "os_sensor", "os_lidar"}));
  EXPECT_LT(apart(tree.between("/os_lidar", "/base_link")->T_a_b, (kSensor * kLidar).inverse()), 1e-14);
  const auto across = tree.between("os_imu", "os_lidar");
  EXPECT_LT(apart(across->T_a_b, Pose::translation_of(0, 0, -0.01) * kLidar), 1e-14);
  EXPECT_EQ(across->frames, (std::vector<std::string>{"os_imu", "os_sensor", "os_lidar"}));
  EXPECT_EQ(apart(tree.between("os_imu", "os_imu")->T_a_b, Pose()), 0.0);
}

TEST(FrameTree, ASingleLinkKeepsEveryBit) {
  const auto chain = ouster().between("base_link", "os_sensor");
  ASSERT_TRUE(chain) << chain.error().message;
  EXPECT_EQ(chain->T_a_b.translation(), kSensor.translation());
  EXPECT_EQ(chain->T_a_b.rotation().coeffs(), kSensor.rotation().coeffs());
}

TEST(FrameTree, FramesThatAreNotLinkedAndCircles) {
  FrameTree tree = ouster();
  EXPECT_ERROR(tree.between("base_link", "camera"), "no links connect 'base_link' and 'camera'");
  EXPECT_ERROR(tree.between("base_link", "velodyne"), "no links connect");
  tree.add("os_lidar", "base_footprint", Pose());
  EXPECT_ERROR(tree.between("base_link", "os_lidar"), "in a circle");
}

TEST(FrameTree, ALaterLinkReplacesAnEarlierOne) {
  FrameTree tree = ouster();
  tree.add("base_link", "os_sensor", Pose());
  EXPECT_LT(apart(tree.between("base_link", "os_lidar")->T_a_b, kLidar), 1e-14);
}

TEST(FrameTree, TheBodyIsTheFrameOnTheFloorOrTheOneThatIsCalledSo) {
  FrameTree tree = ouster();
  EXPECT_EQ(tree.body_of("/os_lidar"), "base_footprint");
  EXPECT_EQ(tree.body_of("camera"), "table");
  EXPECT_EQ(tree.body_of("velodyne"), "");
  FrameTree prefixed;
  prefixed.add("map", "robot_0/base_link", Pose());
  prefixed.add("robot_0/base_link", "robot_0/lidar", Pose());
  EXPECT_EQ(prefixed.body_of("robot_0/lidar"), "robot_0/base_link");
}

// Walked over frame by frame for each frame, a chain of so many would take hours.
TEST(FrameTree, ALongChainIsWalkedOverOnce) {
  constexpr int kLinks = 20'000;
  FrameTree tree;
  for (int i = 0; i < kLinks; ++i) tree.add("f" + std::to_string(i), "f" + std::to_string(i + 1), Pose());
  const std::string last = "f" + std::to_string(kLinks);
  EXPECT_EQ(tree.up_to_root(last).size(), kLinks + 1U);
  EXPECT_EQ(tree.body_of(last), "f0");
}

}  // namespace
}  // namespace adit

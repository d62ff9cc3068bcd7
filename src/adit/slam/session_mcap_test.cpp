// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/session_mcap.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "adit/io/bag.hpp"
#include "adit/io/ros_messages.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

/// A robot that drives 2 m along x from `begin_s` on, five scans, of which the first and the last are
/// keyframes.
PlacedRobot robot(std::uint8_t id, const std::string& name, std::int64_t begin_s, std::size_t shared_map) {
  auto map = std::make_shared<RobotMap>();
  map->id = RobotId{id};
  map->name = name;
  auto cloud = std::make_shared<PointCloud>();
  cloud->points = {{1.0F, 0.0F, 0.0F}, {0.0F, 1.0F, 0.5F}};
  PlacedRobot out;
  for (int i = 0; i < 5; ++i) {
    const Stamp stamp{begin_s * 1'000'000'000 + std::int64_t{i} * 100'000'000};
    map->odometry.push_back({stamp, Pose::translation_of(0.5 * i, 0.0, 0.0)});
    if (i % 4 != 0) continue;
    Keyframe keyframe;
    keyframe.stamp = stamp;
    keyframe.T_odom_base = map->odometry.back().T_world_body;
    keyframe.cloud = cloud;
    map->keyframes.push_back(keyframe);
    map->pose_noise.push_back(Matrix6::Identity() * 1e-4);
    out.T_world_keyframe.push_back(Pose::translation_of(10.0, 0.0, 0.0) * keyframe.T_odom_base);
  }
  out.map = map;
  out.shared_map = shared_map;
  return out;
}

SavedLoop loop(const PlacedRobot& from, const PlacedRobot& to, double weight) {
  SavedLoop out;
  out.from_robot = from.map->name;
  out.to_robot = to.map->name;
  out.from_stamp = from.map->keyframes[0].stamp;
  out.to_stamp = to.map->keyframes[1].stamp;
  out.loop.verdict = LoopVerdict::accepted;
  out.weight = weight;
  return out;
}

PlacedSession session() {
  PlacedSession out;
  out.robots = {robot(0, "2024 05-01", 100, 0), robot(1, "b", 7'000, 0), robot(2, "apart", 200, 1)};
  auto empty = std::make_shared<RobotMap>();
  empty->name = "empty";
  out.robots.push_back({empty, {}, 2});
  out.saved.loops = {loop(out.robots[0], out.robots[1], 1.0), loop(out.robots[0], out.robots[1], 0.1),
                     loop(out.robots[2], out.robots[2], 1.0), loop(out.robots[1], out.robots[2], 1.0)};
  return out;
}

std::vector<ros::TransformMessage> transforms_of(const Bag& bag) {
  std::vector<ros::TransformMessage> out;
  for (const BagMessage& message : bag.messages) {
    if (bag.topics[message.topic].name != "/tf") continue;
    const auto both = ros::decode_transforms(bag.read(message).value()).value().links;
    out.insert(out.end(), both.begin(), both.end());
  }
  return out;
}

TEST(SessionMcap, NamesAreThoseThatRosTakes) {
  PlacedSession named;
  for (const char* name : {"a-1", "a 1", "7", "\xC3\xA4"}) {
    auto map = std::make_shared<RobotMap>();
    map->name = name;
    named.robots.push_back({map, {}, 0});
  }
  EXPECT_EQ(ros_names(named), (std::vector<std::string>{"a_1", "a_1_2", "robot_7", "__"}));
}

TEST(SessionMcap, EachSharedMapHasItsFrameAndRobotsWithoutAMapHaveNone) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_session_mcap(folder / "s.mcap", session(), 0.1, false));
  const Bag bag = open_bag(folder / "s.mcap").value();
  const auto num_of = [&](const std::string& frame, const std::string& child) {
    return std::ranges::count_if(transforms_of(bag), [&](const ros::TransformMessage& link) {
      return link.frame == frame && link.child == child;
    });
  };
  EXPECT_EQ(num_of("map", "robot_2024_05_01/odom"), 5);
  EXPECT_EQ(num_of("robot_2024_05_01/odom", "robot_2024_05_01/base_link"), 5);
  EXPECT_EQ(num_of("map", "b/odom"), 5);
  EXPECT_EQ(num_of("map_2", "apart/odom"), 5);
  for (const ros::TransformMessage& link : transforms_of(bag)) {
    if (!link.child.ends_with("/odom")) continue;
    EXPECT_LT((link.pose.T_world_body.inverse() * Pose::translation_of(10, 0, 0)).log().norm(), 1e-9);
  }
  EXPECT_FALSE(
      std::ranges::any_of(bag.topics, [](const BagTopic& t) { return t.name.starts_with("/empty"); }));
  EXPECT_EQ(bag.messages.back().log_time, Stamp{7'000'400'000'000});
  ASSERT_TRUE(write_session_mcap(folder / "s.mcap", session(), 0.1, true));
  EXPECT_EQ(open_bag(folder / "s.mcap")->messages.back().log_time, Stamp{100'400'000'000});
}

TEST(SessionMcap, LoopsAreDrawnInTheFrameOfBothEnds) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_session_mcap(folder / "s.mcap", session(), 0.1, false));
  const Bag bag = open_bag(folder / "s.mcap").value();
  const auto graph = std::ranges::find_if(
      bag.messages, [&](const BagMessage& m) { return bag.topics[m.topic].name == "/graph"; });
  const std::string content = bag.read(*graph).value();
  MessageReader reader(content);
  ASSERT_EQ(reader.number<std::uint32_t>(),
            6U);  // used and unused of the first map, used of the second; lines and ends
  EXPECT_EQ(reader.number<std::int32_t>(), 100);
  EXPECT_EQ(reader.number<std::uint32_t>(), 0U);
  EXPECT_EQ(reader.text(), "map");
  EXPECT_EQ(reader.text(), "loops in use");
}

TEST(SessionMcap, StampsThatRosCannotHoldAreNamed) {
  const test::TemporaryFolder folder;
  PlacedSession late = session();
  late.robots[1] = robot(1, "b", 3'000'000'000, 0);
  const Result<> written = write_session_mcap(folder / "s.mcap", late, 0.1, true);
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("b: the stamp"), std::string::npos) << written.error().message;
  EXPECT_FALSE(write_session_mcap(folder / "s.mcap", {}, 0.1, false));
  EXPECT_FALSE(std::filesystem::exists(folder / "s.mcap"));
}

}  // namespace
}  // namespace adit

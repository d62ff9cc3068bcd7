// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Robots that are there twice; sessions and recordings of them are in mapping_test.cpp.
#include "adit/slam/repeated_robots.hpp"

#include <gtest/gtest.h>

#include <variant>

#include "support/box_world.hpp"

namespace adit {
namespace {

/// A short drive, by its id another one.
RobotMap short_drive(std::uint8_t id) {
  static const test::BoxWorld world(7, 10.0);
  return test::drive(world, {id}, {Pose(), Pose::planar(2.0, 0.1 * id, 0.0)}, 0.0);
}

std::shared_ptr<RobotMap> called(RobotMap map, const std::string& name, std::uint8_t id) {
  map.name = name;
  map.id = {id};
  for (Keyframe& keyframe : map.keyframes) keyframe.id.robot = map.id;
  return std::make_shared<RobotMap>(std::move(map));
}

LoopClosure loop_between(std::uint8_t from, std::uint8_t to) {
  LoopClosure loop;
  loop.from = {{from}, 0};
  loop.to = {{to}, 1};
  return loop;
}

MergeCheck check_between(std::uint8_t a, std::uint8_t b) {
  MergeCheck check;
  check.a = {a};
  check.b = {b};
  return check;
}

TEST(RepeatedRobots, AreTheSameWhateverTheyAreCalled) {
  const RobotMap map = short_drive(0);
  EXPECT_TRUE(is_same_drive(map, *called(map, "other", 4)));
  EXPECT_FALSE(is_same_drive(map, short_drive(1)));
  RobotMap seen_otherwise = map;
  PointCloud cloud = *map.keyframes.back().cloud;
  cloud.points.back().x() += 0.001F;
  seen_otherwise.keyframes.back().cloud = std::make_shared<const PointCloud>(cloud);
  EXPECT_FALSE(is_same_drive(map, seen_otherwise)) << "as of two robots that a simulation starts together";
  EXPECT_FALSE(is_same_drive(RobotMap(), RobotMap())) << "nothing was mapped";
}

TEST(RepeatedRobots, GoWithWhatWasFoundAboutThem) {
  std::vector<SavedFleet> saved(2);
  saved[0].maps = {called(short_drive(0), "ada", 0)};
  saved[0].read_from = "team_a";
  saved[1].maps = {called(short_drive(1), "bo", 0), called(short_drive(0), "eve", 1),
                   called(short_drive(2), "cy", 2)};
  saved[1].read_from = "team_b";
  saved[1].provenance.robots = {{"bo", "plane-icp", "", 2, ""}, {"eve", "plane-icp", "", 2, ""}};
  saved[1].findings = {Loops{{0}, 0, {loop_between(0, 1), loop_between(0, 2)}},
                       Loops{{0}, 2, {loop_between(0, 1)}},
                       Loops{{0}, 3, {loop_between(0, 2)}},
                       Loops{{1}, 0, {loop_between(1, 2)}},
                       MergeChecks{{0}, 0, {check_between(0, 1), check_between(0, 2)}},
                       MergeChecks{{1}, 0, {check_between(1, 1), check_between(1, 2)}}};
  const std::vector<TakenOut> taken = take_out_repeated(saved);
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].session, 1U);
  EXPECT_EQ(taken[0].name, "eve");
  EXPECT_EQ(taken[0].same, saved[0].maps[0]);
  EXPECT_TRUE(taken[0].sentence.starts_with("eve of team_b and ada of team_a have the same map, to the bit"))
      << taken[0].sentence;
  ASSERT_EQ(saved[1].maps.size(), 2U);
  EXPECT_EQ(saved[1].maps[1]->name, "cy");
  EXPECT_TRUE(saved[1].provenance.robots[0].failure.empty());
  EXPECT_EQ(saved[1].provenance.robots[1].failure, taken[0].sentence);

  ASSERT_EQ(saved[1].findings.size(), 3U) << "those of the others alone";
  const auto& first = std::get<Loops>(saved[1].findings[0]);
  const auto& second = std::get<Loops>(saved[1].findings[1]);
  EXPECT_EQ(first.loops.size(), 1U);
  EXPECT_EQ(second.first, 1U) << "numbers go on without gaps";
  EXPECT_EQ(second.loops.at(0).to.robot, (RobotId{2}));
  const auto& checks = std::get<MergeChecks>(saved[1].findings[2]);
  ASSERT_EQ(checks.checks.size(), 1U);
  EXPECT_EQ(checks.checks[0].b, (RobotId{2}));
}

TEST(RepeatedRobots, OfRecordingsTheFirstCounts) {
  const std::shared_ptr<const RobotMap> known = called(short_drive(0), "ada", 0);
  std::vector<MappedRobot> mapped = {{called(short_drive(1), "bo", 1), "plane-icp", ""},
                                     {called(short_drive(0), "ada_2", 2), "plane-icp", ""},
                                     {called(short_drive(1), "cy", 3), "plane-icp", ""}};
  const std::vector<RepeatedRobot> repeated = leave_out_repeated({known}, mapped);
  ASSERT_EQ(mapped.size(), 1U);
  EXPECT_EQ(mapped[0].map->name, "bo");
  ASSERT_EQ(repeated.size(), 2U);
  EXPECT_EQ(repeated[0].name, "ada_2");
  EXPECT_EQ(repeated[0].same_as, "ada");
  EXPECT_EQ(repeated[1].same_as, "bo");
  EXPECT_FALSE(repeated[1].was_saved);
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/fleet_solution.hpp"

#include <gtest/gtest.h>

#include "support/circling_fleet.hpp"

namespace adit {
namespace {

using test::add_loop;
using test::kNodes;
using test::largest_error;
using test::robots_without_loops;

TEST(FleetGraph, RobotsWithoutLoopsStayApartWithAReason) {
  const FleetSolution solution = solve(robots_without_loops(2), {});
  ASSERT_EQ(solution.components.size(), 2U);
  ASSERT_EQ(solution.pairs.size(), 1U);
  EXPECT_FALSE(solution.pairs[0].merged);
  EXPECT_EQ(solution.pairs[0].refused_kind, RefusalKind::no_loop);
  EXPECT_NE(solution.pairs[0].refused_reason.find("resembled"), std::string::npos);
  EXPECT_NE(solution.pairs[0].refused_reason.find("drive on until"), std::string::npos);
  EXPECT_LT(largest_error(solution, solution.components[1]), 1e-9);
}

TEST(FleetGraph, ByDefaultLoopsThatNothingCheckedJoinNoMaps) {
  FleetGraph fleet;  // as a user of the library makes it
  fleet.robots = robots_without_loops(2).robots;
  for (std::uint32_t k = 5; k < 35; k += 5) add_loop(fleet, {{0}, k}, {{1}, k});
  const FleetSolution apart = solve(fleet, {});
  EXPECT_FALSE(apart.pairs[0].merged);
  EXPECT_EQ(apart.components.size(), 2U);
  EXPECT_EQ(apart.pairs[0].refused_kind, RefusalKind::too_little);
  EXPECT_NE(apart.pairs[0].refused_reason.find("never compared"), std::string::npos);
  fleet.policy = MergePolicy::paper;
  EXPECT_TRUE(solve(fleet, {}).pairs[0].merged);
}

TEST(FleetGraph, ThreeRobotsInARowShareTheFrameOfTheSmallestId) {
  FleetGraph fleet = robots_without_loops(4, MergePolicy::paper);
  for (std::uint32_t k = 5; k < 35; k += 5) {
    add_loop(fleet, {{1}, k}, {{2}, k});
    add_loop(fleet, {{2}, k}, {{3}, k});
  }
  const FleetSolution solution = solve(fleet, {});
  ASSERT_EQ(solution.components.size(), 2U);
  EXPECT_EQ(solution.components[0].robots, std::vector<RobotId>{{0}});
  EXPECT_EQ(solution.components[1].anchor, RobotId{1});
  EXPECT_EQ(solution.components[1].robots, (std::vector<RobotId>{{1}, {2}, {3}}));
  EXPECT_LT(largest_error(solution, solution.components[1]), 0.05);
}

TEST(FleetGraph, LoopsThatAreTooFewDoNotJoinMaps) {
  FleetGraph fleet = robots_without_loops(2, MergePolicy::paper);
  add_loop(fleet, {{0}, 10}, {{1}, 10});
  BackEndConfig config;
  config.min_loops = 2;
  const FleetSolution solution = solve(fleet, config);
  EXPECT_FALSE(solution.pairs[0].merged);
  EXPECT_NE(solution.pairs[0].refused_reason.find("only 1 of 1 loops"), std::string::npos);
  EXPECT_NE(solution.pairs[0].refused_reason.find("2 needed; drive"), std::string::npos);
  EXPECT_EQ(solution.components.size(), 2U);
  EXPECT_LT(largest_error(solution, solution.components[1]), 1e-6);
}

TEST(FleetGraph, AMapThatCannotBeSolvedSaysSo) {
  FleetGraph fleet = robots_without_loops(2, MergePolicy::paper);
  BackEndConfig config;
  config.pcm_on = false;
  for (std::uint32_t k = 5; k < 35; k += 5) add_loop(fleet, {{0}, k}, {{1}, k});
  for (auto& [ends, loop] : fleet.loops) loop.information = -1e12 * Matrix6::Identity();
  const FleetSolution solution = solve(fleet, config);
  const PairOutcome& pair = solution.pairs.at(0);
  ASSERT_FALSE(pair.merged);
  EXPECT_NE(pair.refused_reason.find("6 loops, but the map that they make could not be solved: "),
            std::string::npos)
      << pair.refused_reason;
  EXPECT_EQ(pair.refused_kind, RefusalKind::unknown);
}

TEST(FleetGraph, WhatWasNotComparedIsNotSaidToDiffer) {
  FleetGraph fleet = robots_without_loops(2, MergePolicy::paper);
  const auto refusal = [&] { return solve(fleet, {}).pairs.at(0).refused_reason; };
  fleet.unsearched[{{0}, {1}}] = "robot_0 has not searched robot_1";
  EXPECT_EQ(refusal(), "robot_0 has not searched robot_1");

  add_loop(fleet, {{0}, 5}, {{1}, 6});
  LoopClosure rejected = fleet.loops.begin()->second;
  rejected.to.index = 7;
  rejected.verdict = LoopVerdict::rejected;
  rejected.reason = "8 inliers, 20 needed";
  fleet.loops[{rejected.from, rejected.to}] = rejected;
  fleet.robots[{1}].nodes.resize(4);  // the part that the loop lies on was lost
  EXPECT_NE(refusal().find("1 loops, but the odometry"), std::string::npos) << refusal();
  fleet.loops.erase(fleet.loops.begin());
  EXPECT_NE(refusal().find("none of 1 candidates could be registered (mostly: 8 inliers"), std::string::npos)
      << refusal();
}

TEST(FleetGraph, RobotWithoutKeyframesStopsNobody) {
  FleetGraph fleet = robots_without_loops(3, MergePolicy::paper);
  fleet.robots[{1}].nodes.clear();
  for (std::uint32_t k = 5; k < 35; k += 5) add_loop(fleet, {{0}, k}, {{2}, k});
  const FleetSolution solution = solve(fleet, {});
  EXPECT_TRUE(solution.T_world_keyframe.at({1}).empty());
  EXPECT_EQ(solution.T_world_keyframe.at({2}).size(), kNodes);
  for (const PairOutcome& pair : solution.pairs) {
    EXPECT_EQ(pair.merged, pair.a == RobotId{0} && pair.b == RobotId{2});
    const bool said = pair.refused_reason.find("left no keyframe of robot_1") != std::string::npos;
    EXPECT_NE(pair.merged, said) << pair.refused_reason;
  }
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/loop_selection.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "adit/core/rng.hpp"
#include "support/circling_fleet.hpp"

namespace adit {
namespace {

using test::add_loop;
using test::kNodes;
using test::largest_error;
using test::robots_without_loops;
using test::true_pose;

TEST(LoopSelection, SortsLoopsByPairsAndChoosesNoneThatWasNeverTestedWithinARobot) {
  FleetGraph fleet = robots_without_loops(3, MergePolicy::paper);
  add_loop(fleet, {{0}, 10}, {{1}, 10});
  add_loop(fleet, {{2}, 0}, {{2}, 39});
  const LoopSelection selection = select_loops(fleet, {});
  ASSERT_EQ(selection.loops.size(), 2U);
  EXPECT_EQ(selection.pairs.size(), 3U);
  const LoopsOfPairs expected = {{{{0}, {1}}, {0}}, {{{0}, {2}}, {}}, {{{1}, {2}}, {}}, {{{2}, {2}}, {1}}};
  EXPECT_EQ(selection.of_pairs, expected);
  EXPECT_TRUE(selection.loops[0].is_selected);
  EXPECT_FALSE(selection.loops[1].is_selected);
}

TEST(LoopSelection, WhereChecksAreNeededOnlyTheLoopsOfAnAcceptedOneCount) {
  FleetGraph fleet = robots_without_loops(2);
  for (std::uint32_t k = 5; k < 35; k += 5) add_loop(fleet, {{0}, k}, {{1}, k});
  // False loops that agree with one another, and outnumber the true ones.
  const Pose off = true_pose({1}, 0).inverse() * Pose::planar(4.0, 3.0, 0.0) * true_pose({1}, 0);
  for (std::uint32_t k = 4; k < 36; k += 2)
    add_loop(fleet, {{0}, k}, {{1}, k + 1}, true_pose({1}, k + 1).inverse() * off * true_pose({1}, k + 1));
  BackEndConfig config;
  const PairOutcome untested = solve(fleet, config).pairs[0];
  EXPECT_FALSE(untested.merged);
  EXPECT_NE(untested.refused_reason.find("have to meet again"), std::string::npos) << untested.refused_reason;

  MergeCheck check{{0}, {1}, -3.0, 9.0, 8, 4, false, {}, "scans differ at 4 of 8 places"};
  check.refused_kind = RefusalKind::changed_or_other;
  fleet.checks[{{0}, {1}}] = check;
  const FleetSolution refused = solve(fleet, config);
  EXPECT_FALSE(refused.pairs[0].merged);
  EXPECT_EQ(refused.pairs[0].refused_reason, check.reason);
  EXPECT_EQ(refused.pairs[0].refused_kind, check.refused_kind);
  EXPECT_EQ(refused.components.size(), 2U);

  check.accepted = true;
  for (std::uint32_t k = 5; k < 35; k += 5) check.loops.emplace_back(k, k);
  fleet.checks[{{0}, {1}}] = check;
  const FleetSolution merged = solve(fleet, config);
  ASSERT_TRUE(merged.pairs[0].merged) << merged.pairs[0].refused_reason;
  EXPECT_EQ(merged.pairs[0].num_selected, 6U);
  ASSERT_EQ(merged.components.size(), 1U);
  EXPECT_LT(largest_error(merged, merged.components[0]), 1e-3);
}

/// Loops between two robots that passed their test; with `displaced` they put the second one elsewhere.
void add_merge(FleetGraph& fleet, RobotId a, RobotId b, double evidence, const Pose& displaced = {}) {
  MergeCheck check{a, b, evidence, 9.0, 20, 20, true, {}, "20 of 20 places agree"};
  for (std::uint32_t k = 5; k < 35; k += 5) {
    add_loop(fleet, {a, k}, {b, k}, true_pose(b, k).inverse() * displaced * true_pose(b, k));
    check.loops.emplace_back(k, k);
  }
  fleet.checks[{a, b}] = check;
}

void expect_same_poses(const FleetSolution& first, const FleetSolution& second) {
  ASSERT_EQ(first.components.size(), second.components.size());
  for (const auto& [robot, poses] : first.T_world_keyframe)
    for (std::size_t k = 0; k < poses.size(); ++k)
      EXPECT_EQ(poses[k].matrix(), second.T_world_keyframe.at(robot)[k].matrix());
}

TEST(LoopSelection, AMergeThatLaterOnesContradictIsTakenBack) {
  BackEndConfig config;
  FleetGraph fleet = robots_without_loops(3);
  add_merge(fleet, {0}, {2}, 10.0, Pose::translation_of(25.0, 10.0, 0.0));
  add_merge(fleet, {0}, {1}, 20.0);
  const FleetSolution before = solve(fleet, config);
  EXPECT_TRUE(before.pairs[1].merged) << "nothing speaks against it yet";

  FleetGraph later = fleet;
  add_merge(later, {1}, {2}, 15.0);
  const FleetSolution after = solve(later, config);
  EXPECT_FALSE(after.pairs[1].merged);
  EXPECT_EQ(after.pairs[1].refused_kind, RefusalKind::taken_back);
  EXPECT_EQ(after.pairs[1].refused_reason.find("taken back: with robot_0-robot_1 and robot_1-robot_2"), 0U)
      << after.pairs[1].refused_reason;
  ASSERT_EQ(after.components.size(), 1U) << "robot 2 is joined by robot 1";
  EXPECT_LT(largest_error(after, after.components[0]), 1e-3);
  config.cycles_needed = false;
  for (const PairOutcome& pair : solve(later, config).pairs)
    EXPECT_EQ(pair.refused_reason.find("taken back"), std::string::npos);
  config.cycles_needed = true;

  FleetGraph without_it = robots_without_loops(3);
  add_merge(without_it, {0}, {1}, 20.0);
  add_merge(without_it, {1}, {2}, 15.0);
  expect_same_poses(after, solve(without_it, config));

  later.checks.at({{1}, {2}}).accepted = false;  // withdrawn: no cycle, no contradiction
  expect_same_poses(before, solve(later, config));
  EXPECT_TRUE(solve(later, config).pairs[1].merged);
}

TEST(LoopSelection, OfTwoMapsThatOneTakenBackMergeJoinedBothStayAsTheyWere) {
  BackEndConfig config;
  FleetGraph fleet = robots_without_loops(4);
  add_merge(fleet, {0}, {1}, 20.0);
  add_merge(fleet, {2}, {3}, 20.0);
  const FleetSolution apart = solve(fleet, config);
  // Two merges join the maps of 0 and 1 with those of 2 and 3, and contradict one another: the weaker goes.
  add_merge(fleet, {0}, {2}, 12.0);
  add_merge(fleet, {1}, {3}, 10.0, Pose::translation_of(-30.0, 5.0, 0.0));
  const FleetSolution joined = solve(fleet, config);
  EXPECT_TRUE(joined.pairs[1].merged);
  EXPECT_FALSE(joined.pairs[4].merged);
  ASSERT_EQ(joined.components.size(), 1U);
  EXPECT_LT(largest_error(joined, joined.components[0]), 1e-3);
  // Nothing was lost: without either the maps are what they were.
  fleet.checks.at({{0}, {2}}).accepted = false;
  fleet.checks.at({{1}, {3}}).accepted = false;
  expect_same_poses(apart, solve(fleet, config));
}

// They align the maps as the merges do: accepted loops of hypotheses that scans refute would speak against
// them.
TEST(LoopSelection, LoopsThatRegistrationRejectedRefuteNothing) {
  const auto num_merged = [](LoopVerdict verdict) {
    FleetGraph fleet = robots_without_loops(4);
    add_merge(fleet, {0}, {1}, 20.0);
    add_merge(fleet, {2}, {3}, 20.0);
    add_merge(fleet, {0}, {3}, 10.0);
    for (const auto& [a, b] : std::vector<RobotPair>{{{0}, {2}}, {{1}, {2}}, {{1}, {3}}}) {
      add_loop(fleet, {a, 20}, {b, 20});
      fleet.loops.at({{a, 20}, {b, 20}}).verdict = verdict;
      MergeCheck check{a, b, -9.0, 9.0, 8, 4, false, {{20, 20}}, "scans differ at 4 of 8 places"};
      check.hypotheses = {{HypothesisOutcome::refuted, -9.0, 8, 4, 0.0, {{20, 20}}}};
      fleet.checks[{a, b}] = check;
    }
    return std::ranges::count_if(solve(fleet, {}).pairs, &PairOutcome::merged);
  };
  EXPECT_EQ(num_merged(LoopVerdict::accepted), 2);
  EXPECT_EQ(num_merged(LoopVerdict::rejected), 3);
}

TEST(LoopSelection, LoopsWithinARobotCountWhereAnAcceptedCheckSpeaksOfThem) {
  FleetGraph fleet = robots_without_loops(1);
  std::vector<GraphNode>& nodes = fleet.robots.at({0}).nodes;
  for (std::uint32_t k = 1; k < kNodes; ++k)  // odometry that turns too little
    nodes[k].T_odom_base = nodes[k - 1].T_odom_base * true_pose({0}, k - 1).inverse() * true_pose({0}, k) *
                           Pose::planar(0.0, 0.0, 0.004);
  add_loop(fleet, {{0}, 0}, {{0}, 39});
  add_loop(fleet, {{0}, 2}, {{0}, 37});
  const FleetSolution before = solve(fleet, {});
  ASSERT_EQ(before.components.size(), 1U);
  for (const LoopOutcome& loop : before.loops) EXPECT_FALSE(loop.in_use()) << "never tested";
  fleet.checks[{{0}, {0}}] = {{0}, {0}, 10.0, 9.0, 9, 9, true, {{0, 39}, {2, 37}}, "9 of 9 places agree"};
  const FleetSolution after = solve(fleet, {});
  EXPECT_TRUE(after.pairs.empty());
  for (const LoopOutcome& loop : after.loops) EXPECT_TRUE(loop.in_use());
  EXPECT_LT(largest_error(after, after.components.at(0)), 0.4 * largest_error(before, before.components[0]));
}

TEST(LoopSelection, FalseLoopsAreDroppedByPcm) {
  FleetGraph fleet = robots_without_loops(2, MergePolicy::paper);
  for (std::uint32_t k = 5; k < 35; k += 5) add_loop(fleet, {{0}, k}, {{1}, k});
  Rng rng(5);
  for (std::uint32_t k = 6; k < 35; k += 6) {
    add_loop(fleet, {{0}, k}, {{1}, k + 1},
             Pose::planar(rng.uniform(5, 20), rng.uniform(5, 20), rng.uniform(-3, 3)));
  }
  const FleetSolution solution = solve(fleet, {});
  ASSERT_EQ(solution.components.size(), 1U);
  EXPECT_EQ(solution.components[0].anchor, RobotId{0});
  EXPECT_EQ(solution.pairs[0].num_loops, 11U);
  EXPECT_EQ(solution.pairs[0].num_selected, 6U);
  EXPECT_LT(largest_error(solution, solution.components[0]), 0.05);
  for (const LoopOutcome& outcome : solution.loops) {
    EXPECT_EQ(outcome.in_use(), outcome.loop.to.index == outcome.loop.from.index);
  }
}

TEST(LoopSelection, LoopsOfKeyframesThatAreNotKnownYetWaitForThem) {
  FleetGraph whole = robots_without_loops(3, MergePolicy::paper);
  for (std::uint32_t k = 5; k < 35; k += 5) {
    add_loop(whole, {{0}, k}, {{1}, k});
    add_loop(whole, {{1}, k}, {{2}, k});
  }
  FleetGraph early = whole;
  early.robots.at({1}).nodes.resize(12);  // of six loops to it, those of keyframes 5 and 10 can be used
  early.robots.erase({2});
  const FleetSolution first = solve(early, {});
  ASSERT_EQ(first.loops.size(), 2U);
  ASSERT_EQ(first.components.size(), 1U);
  EXPECT_TRUE(first.pairs[0].merged) << first.pairs[0].refused_reason;
  EXPECT_EQ(first.T_world_keyframe.at({1}).size(), 12U);

  early.robots = whole.robots;  // the rest arrives
  const FleetSolution second = solve(early, {});
  EXPECT_EQ(second.loops.size(), 12U);
  EXPECT_LT(largest_error(second, second.components.at(0)), 0.05);
}

}  // namespace
}  // namespace adit

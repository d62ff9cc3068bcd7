// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/merge_accuracy.hpp"

#include <gtest/gtest.h>

#include "support/circling_fleet.hpp"

namespace adit {
namespace {

FleetSolution merged_by(int num_loops, double sliding_m = 0.0) {
  FleetGraph fleet = test::robots_without_loops(2, MergePolicy::paper);
  for (int i = 0; i < num_loops; ++i) {
    const auto k = static_cast<std::uint32_t>(10 + 3 * i);
    test::add_loop(fleet, {{0}, k}, {{1}, k});
    LoopClosure& loop = fleet.loops.at({{{0}, k}, {{1}, k}});
    if (sliding_m > 0.0) loop.information(0, 0) = 1.0 / (sliding_m * sliding_m);
  }
  BackEndConfig config;
  config.pcm_on = num_loops > 1;
  FleetSolution solution = solve(fleet, config);
  measure_merges(solution);
  return solution;
}

TEST(MergeAccuracy, OneLoopLeavesTheErrorOfThatLoopAndSaysSo) {
  const FleetSolution solution = merged_by(1);
  ASSERT_TRUE(solution.pairs.at(0).accuracy.has_value());
  const MergeAccuracy& accuracy = *solution.pairs[0].accuracy;
  EXPECT_NEAR(accuracy.along_m, 0.1, 1e-3);
  EXPECT_NEAR(accuracy.across_m, 0.1, 1e-3);
  EXPECT_EQ(accuracy.num_loops, 1U);
  EXPECT_NE(to_string(accuracy).find("one loop alone"), std::string::npos);
}

TEST(MergeAccuracy, MoreLoopsKnowItBetter) {
  const FleetSolution solution = merged_by(6);
  ASSERT_TRUE(solution.pairs.at(0).accuracy.has_value());
  EXPECT_LT(solution.pairs[0].accuracy->along_m, 0.08);
  EXPECT_EQ(to_string(*solution.pairs[0].accuracy).find("one loop alone"), std::string::npos);
}

TEST(MergeAccuracy, WhatSlidesIsUncertainAlongTheTunnelAlone) {
  const MergeAccuracy accuracy = merged_by(1, 3.0).pairs.at(0).accuracy.value();
  EXPECT_NEAR(accuracy.along_m, 3.0, 0.05);
  EXPECT_NEAR(accuracy.across_m, 0.1, 1e-3);
}

TEST(MergeAccuracy, NothingIsStatedToBeBetterThanACentimetre) {
  const MergeAccuracy same{2e-4, 4e-5, 0.0123, 0.001, 3, {}, {}, Matrix6::Zero()};
  EXPECT_EQ(to_string(same),
            "known to under 0.01 m along, under 0.01 m across and 0.012 m up, under 0.01 deg");
}

TEST(MergeAccuracy, RobotsThatDidNotMergeHaveNone) {
  FleetSolution solution = solve(test::robots_without_loops(2, MergePolicy::paper), {});
  measure_merges(solution);
  for (const PairOutcome& pair : solution.pairs) EXPECT_FALSE(pair.accuracy.has_value());
}

}  // namespace
}  // namespace adit

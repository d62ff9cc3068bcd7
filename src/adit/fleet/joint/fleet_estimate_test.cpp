// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/fleet_estimate.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"
#include "support/circling_fleet.hpp"

namespace adit {
namespace {

using test::add_loop;
using test::kNodes;
using test::robots_without_loops;

/// Odometry with the errors that its covariances state.
void spoil_odometry(FleetGraph& fleet, std::uint64_t seed) {
  Rng rng(seed);
  for (auto& [robot, own] : fleet.robots) {
    std::vector<GraphNode> exact = own.nodes;
    for (std::size_t k = 1; k < own.nodes.size(); ++k) {
      Vector6 error;
      for (double& x : error) x = rng.normal();
      error = error.cwiseProduct(own.nodes[k].step_covariance.diagonal().cwiseSqrt());
      const Pose step = exact[k - 1].T_odom_base.inverse() * exact[k].T_odom_base;
      own.nodes[k].T_odom_base = own.nodes[k - 1].T_odom_base * step * Pose::exp(error);
    }
  }
}

/// What was known when each robot had driven to its keyframe `num_nodes`.
FleetGraph known_at(const FleetGraph& whole, std::size_t num_nodes) {
  FleetGraph known = whole;
  for (auto& [robot, own] : known.robots) own.nodes.resize(std::min(num_nodes, own.nodes.size()));
  std::erase_if(known.loops, [&](const auto& entry) {
    return !known.knows(entry.first.first) || !known.knows(entry.first.second);
  });
  return known;
}

class Driving : public ::testing::TestWithParam<std::uint64_t> {
 protected:
  FleetGraph whole = robots_without_loops(3, MergePolicy::paper);

  Driving() {
    spoil_odometry(whole, GetParam());
    for (std::uint32_t k = 6; k + 4 < kNodes; k += 2) {
      add_loop(whole, {{0}, k}, {{1}, k + 2});
      if (k > 20) add_loop(whole, {{1}, k}, {{2}, k + 2});
    }
  }
};

TEST_P(Driving, FollowsTheSolutionAndBeginsAMapAnewOnlyWhereRobotsJoin) {
  FleetEstimate estimate;
  std::size_t num_begun = 0;
  for (std::size_t num = 1; num <= kNodes; ++num) {
    const FleetGraph known = known_at(whole, num);
    const FleetEstimate::Step step = estimate.update(known, {});
    EXPECT_TRUE(step.problems.empty());
    EXPECT_EQ(step.num_keyframes, 3U);
    num_begun += step.num_begun_anew;
    const FleetSolution solution = solve(known, {});
    EXPECT_EQ(estimate.maps().size(), solution.components.size()) << num;
    EXPECT_LT(difference(estimate, solution).largest_m, 0.05) << num;
  }
  EXPECT_EQ(num_begun, 5U);  // three robots, the first two together, all together
  EXPECT_EQ(estimate.update(known_at(whole, kNodes), {}).num_keyframes, 0U);
}

INSTANTIATE_TEST_SUITE_P(Seeds, Driving, ::testing::Values(1, 2, 3));

TEST(FleetEstimate, LeavesOutALoopThatTheOthersContradict) {
  FleetGraph fleet = robots_without_loops(2, MergePolicy::paper);
  BackEndConfig config;
  config.pcm_on = false;
  for (std::uint32_t k = 5; k < 35; k += 5) add_loop(fleet, {{0}, k}, {{1}, k});
  add_loop(fleet, {{0}, 12}, {{1}, 30}, Pose::planar(6.0, -4.0, 0.4));
  FleetEstimate estimate;
  estimate.update(fleet, config);
  EXPECT_FALSE(estimate.is_in_use({{{0}, 12}, {{1}, 30}}));
  EXPECT_TRUE(estimate.is_in_use({{{0}, 10}, {{1}, 10}}));
  const Pose T_0_1 = test::true_pose({0}, 0).inverse() * test::true_pose({1}, 20);
  EXPECT_LT((estimate.T_map_keyframe().at({1})[20].translation() - T_0_1.translation()).norm(), 0.05);
}

TEST(FleetEstimate, AMergeThatIsTakenBackLeavesEachRobotAtItsOdometry) {
  FleetGraph fleet = robots_without_loops(2);
  for (std::uint32_t k = 5; k < 35; k += 5) add_loop(fleet, {{0}, k}, {{1}, k});
  MergeCheck check;
  check.a = {0};
  check.b = {1};
  check.accepted = true;
  for (const auto& [ends, loop] : fleet.loops) check.loops.emplace_back(ends.first.index, ends.second.index);
  fleet.checks[{{0}, {1}}] = check;
  FleetEstimate estimate;
  estimate.update(fleet, {});
  ASSERT_EQ(estimate.maps().size(), 1U);
  fleet.checks.begin()->second.accepted = false;
  EXPECT_EQ(estimate.update(fleet, {}).num_begun_anew, 2U);
  ASSERT_EQ(estimate.maps().size(), 2U);
  for (std::uint32_t k = 0; k < kNodes; ++k)
    EXPECT_TRUE(estimate.T_map_keyframe().at({1})[k].matrix().isApprox(
        fleet.robots.at({1}).nodes[k].T_odom_base.matrix(), 1e-9));
}

TEST(FleetEstimate, AnUpdateThatThrowsIsMadeUpForByTheNext) {
  FleetGraph fleet = robots_without_loops(2);
  FleetEstimate estimate;
  estimate.update(known_at(fleet, 10), {});
  FleetGraph broken = fleet;  // in the second map, so that the first has been taken over by then
  add_loop(broken, {{1}, 5}, {{1}, 5});
  broken.checks[{{1}, {1}}].accepted = true;
  broken.checks[{{1}, {1}}].loops = {{5, 5}};
  EXPECT_THROW(estimate.update(broken, {}), ContractViolation);
  const FleetEstimate::Step step = estimate.update(fleet, {});
  EXPECT_TRUE(step.problems.empty());
  EXPECT_EQ(step.num_begun_anew, 2U);
  EXPECT_EQ(estimate.maps().size(), 2U);
  EXPECT_LT(difference(estimate, solve(fleet, {})).largest_m, 1e-6);
}

TEST(FleetEstimate, ARobotWithoutKeyframesIsInNoMap) {
  FleetGraph fleet = robots_without_loops(2);
  fleet.robots[{1}].nodes.clear();
  FleetEstimate estimate;
  const FleetEstimate::Step step = estimate.update(fleet, {});
  EXPECT_TRUE(step.problems.empty());
  EXPECT_EQ(estimate.maps(), (std::vector<std::vector<RobotId>>{{RobotId{0}}}));
  EXPECT_FALSE(estimate.T_map_keyframe().contains({1}));
}

}  // namespace
}  // namespace adit

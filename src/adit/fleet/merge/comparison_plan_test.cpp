// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/comparison_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <set>

#include "adit/odometry/path_uncertainty.hpp"
#include "adit/robot/robot_map.hpp"
#include "support/opposite_drives.hpp"

namespace adit {
namespace {

using test::along_x;
using test::kNum;
using test::kTrueLoops;
using test::T_a_b_true;

std::vector<PlannedComparison> plan_of(const std::vector<PcmLoop>& loops) {
  const OdometryChain drive = along_x(kNum);
  const OdometryChain other = along_x(kNum);
  return ComparisonPlanner(drive, other, loops, {.reach_m = 50.0}).plan(200);
}

TEST(ComparisonPlanner, PutsNeighboursTogetherAllAlongTheStretch) {
  const std::vector<PlannedComparison> plan = plan_of(kTrueLoops);
  // 50 m to each side of the loops and the 10 m between them, every 3 m; both drives end sooner.
  ASSERT_GE(plan.size(), 30U);
  std::set<std::uint32_t> theirs;
  for (const PlannedComparison& check : plan) {
    EXPECT_TRUE(theirs.insert(check.theirs).second) << "twice: " << check.theirs;
    const Pose T_true = T_a_b_true(check.own, check.theirs);
    EXPECT_LT((check.T_own_theirs.inverse() * T_true).log().norm(), 1e-9);
    EXPECT_LT(T_true.translation().norm(), 1.1);  // the lane, and a quarter of a metre along it
  }
}

TEST(ComparisonPlanner, LooksFarApartFirst) {
  const std::vector<PlannedComparison> plan = plan_of(kTrueLoops);
  std::vector<std::uint32_t> first;
  for (std::size_t i = 0; i < 4; ++i) first.push_back(plan[i].theirs);
  std::ranges::sort(first);
  for (std::size_t i = 1; i < first.size(); ++i) EXPECT_GT(first[i] - first[i - 1], 20U);
}

TEST(ComparisonPlanner, WithoutLoopsThereIsNothingToCheck) { EXPECT_TRUE(plan_of({}).empty()); }

TEST(ComparisonPlanner, WithinOneMapAKeyframeIsNotComparedWithItselfOrItsNeighbours) {
  std::vector<Pose> poses;  // up a street of 100 m and back
  for (int k = 0; k <= 200; ++k)
    poses.push_back(k <= 100 ? Pose::planar(k, 0.0, 0.0) : Pose::planar(200 - k, 1.0, std::numbers::pi));
  const OdometryChain chain(poses, std::vector<Matrix6>(200, random_walk({}, 1.0)));
  const std::vector<PcmLoop> loops = {{70, 130, chain.between(70, 130)}, {50, 150, chain.between(50, 150)}};
  const std::vector<PlannedComparison> plan =
      ComparisonPlanner(chain, chain, loops, {.reach_m = 50.0}).plan(200);
  ASSERT_GE(plan.size(), 10U);
  for (const PlannedComparison& check : plan) {
    EXPECT_GE(check.theirs, check.own + 40);
    EXPECT_LT((poses[check.own].translation() - poses[check.theirs].translation()).norm(), 3.0);
  }
}

TEST(ComparisonPlanner, PairsBetweenThePlacesAreOfKeyframesThatNoOtherPairHas) {
  const OdometryChain drive = along_x(kNum);
  const OdometryChain other = along_x(kNum);
  const ComparisonPlanner planner(drive, other, kTrueLoops, {.reach_m = 50.0});
  const std::vector<PlannedComparison> plan = planner.plan(200);
  const std::vector<PlannedComparison> between = planner.between(plan, 1000);
  EXPECT_NEAR(static_cast<double>(between.size()), 2.0 * static_cast<double>(plan.size()), 2.0);
  std::set<std::uint32_t> own;
  std::set<std::uint32_t> theirs;
  for (const auto& pairs : {plan, between}) {
    for (const PlannedComparison& pair : pairs) {
      EXPECT_TRUE(own.insert(pair.own).second) << pair.own;
      EXPECT_TRUE(theirs.insert(pair.theirs).second) << pair.theirs;
      EXPECT_LT((pair.T_own_theirs.inverse() * T_a_b_true(pair.own, pair.theirs)).log().norm(), 1e-9);
    }
  }
  EXPECT_EQ(planner.between(plan, 7).size(), 7U);
  EXPECT_TRUE(planner.between({}, 7).empty());
}

TEST(ComparisonPlanner, TheSecondLookIsAMetreOnAndAtTheEndAMetreBack) {
  const OdometryChain drive = along_x(kNum);
  const OdometryChain other = along_x(kNum);
  const ComparisonPlanner planner(drive, other, kTrueLoops, {.reach_m = 60.0});
  for (const PlannedComparison& check : planner.plan(200)) {
    const auto again = planner.second_look(check);
    ASSERT_TRUE(again);
    const double by = 0.5 * (static_cast<double>(again->theirs) - static_cast<double>(check.theirs));
    EXPECT_NEAR(std::abs(by), 1.0, 1e-9);
    EXPECT_EQ(by < 0.0, check.theirs + 2 >= kNum);
    EXPECT_LT((again->T_own_theirs.inverse() * T_a_b_true(again->own, again->theirs)).log().norm(), 1e-9);
  }
}

TEST(ComparisonPlanner, NoPairIsItsOwnSecondLook) {
  std::vector<Pose> poses;  // farther apart than a second look is
  for (int k = 0; k < 20; ++k) poses.push_back(Pose::planar(1.5 * k, 0.0, 0.0));
  const OdometryChain drive(poses, std::vector<Matrix6>(19, random_walk({}, 1.5)));
  const OdometryChain other = drive;
  const std::vector<PcmLoop> loops = {{10, 10, Pose(), Matrix6::Identity()}};
  const ComparisonPlanner planner(drive, other, loops, {.spacing_m = 1.0, .reach_m = 50.0});
  const std::vector<PlannedComparison> plan = planner.plan(200);
  ASSERT_EQ(plan.size(), 20U);
  for (const PlannedComparison& place : plan) {
    const auto again = planner.second_look(place);
    ASSERT_EQ(again.has_value(), place.theirs != 19U);
    EXPECT_EQ(again ? again->theirs : 20U, place.theirs + 1);
  }
}

}  // namespace
}  // namespace adit

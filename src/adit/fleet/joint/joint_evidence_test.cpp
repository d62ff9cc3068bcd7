// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/joint_evidence.hpp"
#include "adit/fleet/merge/merge_evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "adit/fleet/merge/merge_evidence.hpp"
#include "support/circling_fleet.hpp"

namespace adit {
namespace {

using test::add_loop;
using test::robots_without_loops;
using test::true_pose;

constexpr double kNeeded = 6.9;
constexpr double kGoesOn = 0.3;
const double kOfAPlace =
    std::log(kFleetEvidence.agreement_if_true / kGoesOn);  // five are too few, ten enough

constexpr double kOfWalls = 1.2;

/// Which keyframe of a robot stands at an angle of the circle.
std::uint32_t at(RobotId robot, double angle) {
  return static_cast<std::uint32_t>(std::lround((angle - 0.4 * robot.value) / 0.06));
}

/// A hypothesis about two robots that agree at five places from `angle` on, whose walls say a little;
/// `displaced` puts b elsewhere.
void add_hypothesis(FleetGraph& fleet, RobotId a, RobotId b, double angle, HypothesisOutcome outcome,
                    const Pose& displaced = {}) {
  MergeCheck& check = fleet.checks[{a, b}];
  check.a = a;
  check.b = b;
  check.needed = kNeeded;
  check.goes_on.fill(kGoesOn);
  MergeHypothesis hypothesis{outcome, 5.0 * kOfAPlace, 5, 5, 0.0, {}};
  hypothesis.walls = kOfWalls;
  for (int i = 0; i < 5; ++i) {
    const std::uint32_t ka = at(a, angle + 0.15 * i);
    const std::uint32_t kb = at(b, angle + 0.15 * i);
    hypothesis.places.push_back({ka, kb, PlaceOutcome::distinctive});
    if (i % 2 != 0) continue;
    // Of several hypotheses each has loops of its own.
    const auto end = kb + static_cast<std::uint32_t>(check.hypotheses.size());
    add_loop(fleet, {a, ka}, {b, end}, true_pose(b, end).inverse() * displaced * true_pose(b, end));
    hypothesis.loops.emplace_back(ka, end);
  }
  check.hypotheses.push_back(std::move(hypothesis));
}

/// Of robots 0 and 1, which share a map, and a third.
FleetGraph two_and_one() {
  FleetGraph fleet = robots_without_loops(3);
  add_hypothesis(fleet, {0}, {1}, 1.0, HypothesisOutcome::accepted);
  MergeCheck& check = fleet.checks.at({{0}, {1}});
  check.accepted = true;
  check.loops = check.hypotheses[0].loops;
  return fleet;
}

FleetSolution solved(const FleetGraph& fleet) { return solve(fleet, {}); }

constexpr HypothesisOutcome kUnsure = HypothesisOutcome::unsure;
const Pose kElsewhere = Pose::translation_of(9.0, 5.0, 0.0);

TEST(JointEvidence, TwoPairsTogetherJoinWhatNeitherCouldAlone) {
  FleetGraph fleet = two_and_one();
  add_hypothesis(fleet, {0}, {2}, 0.9, kUnsure);
  EXPECT_EQ(solved(fleet).components.size(), 2U);
  add_hypothesis(fleet, {1}, {2}, 2.0, kUnsure);
  const FleetSolution together = solved(fleet);
  ASSERT_EQ(together.components.size(), 1U);
  EXPECT_LT(test::largest_error(together, together.components[0]), 1e-3);
  for (const PairOutcome& pair : together.pairs) {
    EXPECT_TRUE(pair.merged) << pair.refused_reason;
    EXPECT_EQ(pair.joined_reason.empty(), pair.a == RobotId{0} && pair.b == RobotId{1});
  }
  EXPECT_NE(
      together.pairs[1].joined_reason.find("robot_0-robot_2 (5.8) and robot_1-robot_2 (5.8) say the same"),
      std::string::npos)
      << together.pairs[1].joined_reason;
}

TEST(JointEvidence, CanBeSwitchedOff) {
  FleetGraph fleet = two_and_one();
  add_hypothesis(fleet, {0}, {2}, 0.9, kUnsure);
  add_hypothesis(fleet, {1}, {2}, 2.0, kUnsure);
  BackEndConfig config;
  config.joint_evidence = false;
  EXPECT_EQ(solve(fleet, config).components.size(), 2U);
}

TEST(JointEvidence, APlaceThatTwoPairsComparedCountsOnce) {
  FleetGraph fleet = two_and_one();
  add_hypothesis(fleet, {0}, {2}, 1.3, kUnsure);
  add_hypothesis(fleet, {1}, {2}, 1.3, kUnsure);
  EXPECT_EQ(solved(fleet).components.size(), 2U);
}

TEST(JointEvidence, PairsThatSayDifferentThingsJoinNothing) {
  FleetGraph fleet = two_and_one();
  add_hypothesis(fleet, {0}, {2}, 0.9, kUnsure);
  add_hypothesis(fleet, {1}, {2}, 2.0, kUnsure, kElsewhere);
  EXPECT_EQ(solved(fleet).components.size(), 2U);
}

TEST(JointEvidence, WhatAThirdPairsScansRefutedIsNotJoined) {
  FleetGraph fleet = robots_without_loops(4);
  for (const auto& [a, b, angle] : {std::tuple(0, 1, 1.0), {1, 3, 2.0}}) {
    const RobotId from{static_cast<std::uint8_t>(a)};
    const RobotId to{static_cast<std::uint8_t>(b)};
    add_hypothesis(fleet, from, to, angle, HypothesisOutcome::accepted);
    MergeCheck& check = fleet.checks.at({from, to});
    check.accepted = true;
    check.loops = check.hypotheses[0].loops;
  }
  add_hypothesis(fleet, {0}, {2}, 0.9, kUnsure);
  add_hypothesis(fleet, {1}, {2}, 2.0, kUnsure);
  EXPECT_EQ(solved(fleet).components.size(), 1U);
  add_hypothesis(fleet, {2}, {3}, 1.5, HypothesisOutcome::refuted);
  EXPECT_EQ(solved(fleet).components.size(), 2U);
}

TEST(JointEvidence, TwoWaysThatAreAlikeLikelyKeepMapsApart) {
  FleetGraph fleet = two_and_one();
  for (const Pose& displaced : {Pose(), kElsewhere}) {
    add_hypothesis(fleet, {0}, {2}, 0.9, kUnsure, displaced);
    add_hypothesis(fleet, {1}, {2}, 2.0, kUnsure, displaced);
  }
  EXPECT_EQ(solved(fleet).components.size(), 2U);
}

TEST(JointEvidence, LoopsOfOtherCyclesThatCloseCostEvidence) {
  FleetGraph fleet = two_and_one();
  add_hypothesis(fleet, {0}, {2}, 0.9, kUnsure);
  add_hypothesis(fleet, {1}, {2}, 2.0, kUnsure);
  const auto evidence = [&] {
    const std::map<RobotId, OdometryChain> chains = {{RobotId{0}, chain_of(fleet.robots.at({0}))},
                                                     {RobotId{1}, chain_of(fleet.robots.at({1}))},
                                                     {RobotId{2}, chain_of(fleet.robots.at({2}))}};
    Merge merge{{0}, {1}, 10.0, {}};
    for (const auto& [a, b] : fleet.checks.at({{0}, {1}}).loops)
      merge.loops.push_back(pcm_loop_of(fleet.loops.at({{{0}, a}, {{1}, b}})));
    const std::vector<JointMerge> joint = joint_merges(fleet, {merge}, chains, {});
    return joint.empty() ? 0.0 : joint.front().evidence;
  };
  const double of_all = unless_copied(10.0 * kOfAPlace, 10.0) + 2.0 * kOfWalls;
  EXPECT_NEAR(evidence(), of_all, 1e-6);
  add_hypothesis(fleet, {0}, {2}, 0.9, HypothesisOutcome::refuted, kElsewhere);
  add_hypothesis(fleet, {1}, {2}, 2.0, HypothesisOutcome::refuted, kElsewhere);
  EXPECT_NEAR(evidence(), of_all - std::log(2.0), 1e-6);
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <set>

#include "adit/core/parallel.hpp"
#include "adit/fleet/agent.hpp"
#include "support/two_robots.hpp"

namespace adit {
namespace {

using test::adaptive;
using test::street;
using test::TwoRobots;

TEST(AdaptiveAgent, MergesRobotsThatShareAStreetAndBothKnowWhy) {
  TwoRobots fleet(3, adaptive());
  fleet.meet();
  const FleetSolution first = fleet.agents[0].solve({});
  const FleetSolution second = fleet.agents[1].solve({});
  ASSERT_TRUE(first.pairs[0].merged) << first.pairs[0].refused_reason;
  const MergeCheck& check = fleet.agents[1].known().checks.at({{0}, {1}});
  EXPECT_TRUE(check.accepted);
  EXPECT_GE(check.evidence, check.needed);
  EXPECT_EQ(check.loops.size(), first.pairs[0].num_selected);
  const Pose T_true = fleet.truth_0.front().inverse();
  for (std::size_t k = 0; k < fleet.truth_1.size(); ++k) {
    EXPECT_LT(
        ((T_true * fleet.truth_1[k]).translation() - first.T_world_keyframe.at({1})[k].translation()).norm(),
        1.5);  // as above; the loops that one hypothesis explains are fewer
    EXPECT_EQ(first.T_world_keyframe.at({1})[k].matrix(), second.T_world_keyframe.at({1})[k].matrix());
  }
}

TEST(AdaptiveAgent, KeepsRobotsOfTwoStreetsApartWithAReason) {
  TwoRobots fleet(3, adaptive());
  const test::BoxWorld elsewhere(77);
  const auto map = std::make_shared<const RobotMap>(test::drive(elsewhere, {1}, fleet.truth_1, -0.002));
  fleet.agents[1] = Agent(map, adaptive());
  fleet.meet();
  const FleetSolution solution = fleet.agents[0].solve({});
  EXPECT_FALSE(solution.pairs[0].merged);
  EXPECT_EQ(solution.components.size(), 2U);
  // And where the other robot would be recognised.
  const MergeCheck& check = fleet.agents[0].known().checks.at({fleet.agents[0].id(), fleet.agents[1].id()});
  ASSERT_TRUE(check.advice) << check.reason;
  EXPECT_GT(check.advice->gain, 0.0);
  EXPECT_NE(solution.pairs[0].refused_reason.find("let robot_1 drive along the path of robot_0 from"),
            std::string::npos)
      << solution.pairs[0].refused_reason;
}

TEST(AdaptiveAgent, RegistersNoMoreCandidatesThanAskedFor) {
  AgentConfig config = adaptive();
  config.adaptive.search.candidates = 4;
  TwoRobots fleet(3, config);
  fleet.meet();
  EXPECT_EQ(fleet.agents[0].known().loops.size(), 4U);
}

/// A robot that drives up the street and back again, on the other lane.
struct ThereAndBack {
  std::vector<Pose> truth = street(0.0, 50.0, -0.5);
  std::shared_ptr<const RobotMap> map;

  explicit ThereAndBack(double yaw_drift = 0.003) {
    for (const Pose& pose : street(50.0, 0.0, 0.5)) truth.push_back(pose);
    map = std::make_shared<const RobotMap>(test::drive(test::BoxWorld(3), {0}, truth, yaw_drift));
  }
  [[nodiscard]] Agent agent(const AgentConfig& config = adaptive()) const { return {map, config}; }
  [[nodiscard]] double largest_error(const FleetSolution& solution) const {
    double worst = 0.0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const Vector3 expected = (truth.front().inverse() * truth[k]).translation();
      worst = std::max(worst, (solution.T_world_keyframe.at({0})[k].translation() - expected).norm());
    }
    return worst;
  }
};

TEST(AdaptiveAgent, FindsThatItCameBackAndMapsBetterAlone) {
  const ThereAndBack robot;
  Agent agent = robot.agent();
  const double before = robot.largest_error(agent.solve({}));
  agent.find_revisits();
  const FleetSolution solution = agent.solve({});
  const MergeCheck& check = agent.known().checks.at({{0}, {0}});
  ASSERT_TRUE(check.accepted) << check.reason;
  EXPECT_LT(robot.largest_error(solution), 0.5 * before);
  EXPECT_TRUE(solution.pairs.empty());
  int in_use = 0;
  for (const LoopOutcome& outcome : solution.loops) {
    if (!outcome.in_use()) continue;
    ++in_use;
    EXPECT_LT(outcome.loop.from, outcome.loop.to);
    const Pose T_true = robot.truth[outcome.loop.from.index].inverse() * robot.truth[outcome.loop.to.index];
    EXPECT_LT((T_true.inverse() * outcome.loop.T_from_to).translation().norm(), 0.5);
  }
  EXPECT_GE(in_use, 2);

  agent.find_revisits();  // again: nothing new
  EXPECT_EQ(agent.known().checks.size(), 1U);
  EXPECT_LE(agent.known().loops.size(),
            static_cast<std::size_t>(adaptive().adaptive.search.revisit_candidates));
}

TEST(AdaptiveAgent, FindsNoRevisitWhereItNeverCameBackOrMayNotLook) {
  TwoRobots fleet(3, adaptive());
  fleet.agents[0].find_revisits();
  EXPECT_TRUE(fleet.agents[0].known().loops.empty());
  EXPECT_TRUE(fleet.agents[0].known().checks.empty());
  AgentConfig config = adaptive();
  config.adaptive.search.revisits = false;
  Agent off = ThereAndBack().agent(config);
  off.find_revisits();
  EXPECT_TRUE(off.known().loops.empty());
}

TEST(AdaptiveAgent, APeerLearnsOfRevisitsAndComputesTheSame) {
  const ThereAndBack robot;
  TwoRobots fleet(3, adaptive());
  fleet.agents[0] = robot.agent();
  fleet.agents[0].find_revisits();
  fleet.meet();
  ASSERT_TRUE(fleet.agents[1].known().checks.contains({{0}, {0}}));
  const FleetSolution first = fleet.agents[0].solve({});
  const FleetSolution second = fleet.agents[1].solve({});
  ASSERT_EQ(first.pairs.size(), 1U);
  const auto within_one = [](const LoopOutcome& loop) {
    return loop.in_use() && loop.loop.from.robot == loop.loop.to.robot;
  };
  EXPECT_GT(std::ranges::count_if(second.loops, within_one), 0);
  for (const auto& [id, poses] : first.T_world_keyframe)
    for (std::size_t k = 0; k < poses.size(); ++k)
      EXPECT_EQ(poses[k].matrix(), second.T_world_keyframe.at(id)[k].matrix());
}

TEST(AdaptiveAgent, RepeatedMessagesAndThreadsChangeNothing) {
  set_num_threads(1);
  TwoRobots once(3, adaptive());
  once.meet();
  set_num_threads(2);
  TwoRobots twice(3, adaptive());
  twice.meet(2);
  twice.meet();
  const auto& a = once.agents[1].known();
  const auto& b = twice.agents[1].known();
  EXPECT_EQ(a.loops.size(), b.loops.size());
  ASSERT_EQ(a.checks.size(), 1U);
  ASSERT_EQ(b.checks.size(), 1U);
  EXPECT_EQ(a.checks.begin()->second.evidence, b.checks.begin()->second.evidence);
  EXPECT_EQ(a.checks.begin()->second.reason, b.checks.begin()->second.reason);
}

TEST(AdaptiveAgent, ASearchWaitsForAGraphThatWasLost) {
  TwoRobots fleet(3, adaptive());
  std::deque<Message> queue;
  const auto meet = [&](bool lose_graphs) {
    for (const Message& message : fleet.agents[0].meet({1})) queue.push_back(message);
    for (int budget = 10000; !queue.empty() && budget > 0; --budget) {
      const Message message = queue.front();
      queue.pop_front();
      if (lose_graphs && std::holds_alternative<GraphPart>(message.body)) continue;
      for (const Message& reply : fleet.agents[message.to.value].on(message)) queue.push_back(reply);
    }
  };
  meet(true);
  EXPECT_TRUE(fleet.agents[0].known().loops.empty());
  EXPECT_TRUE(fleet.agents[0].known().checks.empty());
  meet(false);
  EXPECT_GT(fleet.agents[0].known().loops.size(), 0U);
  ASSERT_EQ(fleet.agents[1].known().checks.size(), 1U);
  EXPECT_TRUE(fleet.agents[0].known().checks.begin()->second.accepted);
}

// The peer's own messages of its path are lost, and what a third robot says of it answers no Hello of the
// peer.
TEST(AdaptiveAgent, ASearchStartsWhereThePathCameByWayOfAThirdRobot) {
  TwoRobots fleet(3, adaptive());
  std::vector<Message> lost;
  const auto meet = [&] {
    std::deque<Message> queue;
    for (const Message& message : fleet.agents[0].meet({1})) queue.push_back(message);
    for (int budget = 10000; !queue.empty() && budget > 0; --budget) {
      const Message message = queue.front();
      queue.pop_front();
      if (message.to == RobotId{0} && std::holds_alternative<GraphPart>(message.body) && lost.empty()) {
        lost.push_back(message);
        continue;
      }
      for (const Message& reply : fleet.agents[message.to.value].on(message)) queue.push_back(reply);
    }
  };
  meet();
  ASSERT_EQ(lost.size(), 1U);
  EXPECT_TRUE(fleet.agents[0].on({{2}, {0}, lost.front().body}).empty());
  EXPECT_TRUE(fleet.agents[0].known().loops.empty());
  meet();
  EXPECT_GT(fleet.agents[0].known().loops.size(), 0U);
  ASSERT_EQ(fleet.agents[1].known().checks.size(), 1U);
}

// As after an exception: of what was saved the check is missing. The peer's path comes in that meeting, or
// has come before by way of a third robot.
TEST(AdaptiveAgent, ACheckThatWasNeverConcludedIsMadeWhenTheRobotsMeetAgain) {
  TwoRobots before(3, adaptive());
  before.meet();
  const MergeCheck concluded = before.agents[0].known().checks.at({{0}, {1}});
  const Hello met = std::get<Hello>(before.agents[0].meet({1}).front().body);
  std::map<RobotId, std::uint32_t> num_places;
  for (const Hello::Known& known : met.known)
    if (known.num_places > 0) num_places[known.robot] = known.num_places;
  std::vector<MessageBody> findings = before.agents[0].findings();
  std::erase_if(findings, [](const MessageBody& body) { return std::holds_alternative<MergeChecks>(body); });
  for (const bool knows_path : {false, true}) {
    TwoRobots fleet(3, adaptive());
    ASSERT_TRUE(fleet.agents[0].restore(findings, num_places));
    if (knows_path) {
      const std::vector<GraphNode>& nodes = before.agents[1].known().robots.at({1}).nodes;
      EXPECT_TRUE(fleet.agents[0].on({{2}, {0}, GraphPart{{1}, "robot_1", 0, nodes}}).empty());
    }
    EXPECT_TRUE(fleet.agents[0].known().checks.empty());
    fleet.meet();
    ASSERT_EQ(fleet.agents[1].known().checks.size(), 1U) << knows_path;
    EXPECT_EQ(fleet.agents[1].known().checks.at({{0}, {1}}).evidence, concluded.evidence);
    EXPECT_EQ(fleet.agents[0].findings().size(), before.agents[0].findings().size()) << "one check";
  }
  // It searches again and may register no more than it has.
  AgentConfig config = adaptive();
  config.max_candidates = 6;
  config.candidates_per_peer = 0;
  TwoRobots all(3, config);
  all.meet();
  findings = all.agents[0].findings();
  std::erase_if(findings, [](const MessageBody& body) { return std::holds_alternative<MergeChecks>(body); });
  TwoRobots fleet(3, config);
  ASSERT_TRUE(fleet.agents[0].restore(findings, {}));
  fleet.meet();
  EXPECT_EQ(fleet.agents[0].known().loops.size(), all.agents[0].known().loops.size());
  EXPECT_EQ(fleet.agents[1].known().checks.size(), 1U);
}

// Every third part of the views is lost, and the robots meet again until the check is over.
TEST(AdaptiveAgent, AsksForAViewOnceUnlessItIsLost) {
  TwoRobots fleet(3, adaptive());
  std::vector<std::uint32_t> asked;  // views, in the order of the requests
  int num_answers = 0;
  const auto meet = [&](bool lose) {
    std::deque<Message> queue;
    for (const Message& message : fleet.agents[0].meet({1})) queue.push_back(message);
    for (int budget = 10000; !queue.empty() && budget > 0; --budget) {
      const Message message = queue.front();
      queue.pop_front();
      if (const auto* request = std::get_if<CloudRequest>(&message.body);
          request != nullptr && request->kind == CloudKind::view)
        asked.insert(asked.end(), request->indices.begin(), request->indices.end());
      const auto* clouds = std::get_if<Clouds>(&message.body);
      if (clouds != nullptr && clouds->kind == CloudKind::view && lose && num_answers++ % 3 == 0) continue;
      for (const Message& reply : fleet.agents[message.to.value].on(message)) queue.push_back(reply);
    }
  };
  meet(false);
  ASSERT_EQ(fleet.agents[1].known().checks.size(), 1U);
  const MergeCheck check = fleet.agents[1].known().checks.begin()->second;
  EXPECT_GT(asked.size(), 8U);
  EXPECT_EQ(std::set(asked.begin(), asked.end()).size(), asked.size());

  fleet = TwoRobots(3, adaptive());
  for (int meeting = 0; meeting < 20 && fleet.agents[1].known().checks.empty(); ++meeting) meet(true);
  ASSERT_EQ(fleet.agents[1].known().checks.size(), 1U);
  EXPECT_GT(num_answers, 1);
  EXPECT_EQ(fleet.agents[1].known().checks.begin()->second.evidence, check.evidence);
}

TEST(AdaptiveAgent, WhatItForgetsOfItsOwnKeyframesChangesNoResult) {
  TwoRobots keeps(3, adaptive());
  keeps.meet();
  EXPECT_GT(keeps.agents[0].num_cached_bytes(), 0U);
  TwoRobots forgets(3, adaptive());
  std::deque<Message> queue;
  for (const Message& message : forgets.agents[0].meet({1})) queue.push_back(message);
  for (int budget = 10000; !queue.empty() && budget > 0; --budget) {
    const Message message = queue.front();
    queue.pop_front();
    for (const Message& reply : forgets.agents[message.to.value].on(message)) queue.push_back(reply);
    forgets.agents[0].forget_cached();
    ASSERT_EQ(forgets.agents[0].num_cached_bytes(), 0U);
  }
  const FleetGraph& one = keeps.agents[0].known();
  const FleetGraph& other = forgets.agents[0].known();
  ASSERT_EQ(one.loops.size(), other.loops.size());
  for (const auto& [ends, loop] : one.loops)
    EXPECT_EQ(loop.T_from_to.matrix(), other.loops.at(ends).T_from_to.matrix());
  EXPECT_EQ(one.checks.begin()->second.evidence, other.checks.begin()->second.evidence);
  EXPECT_EQ(one.checks.begin()->second.reason, other.checks.begin()->second.reason);
}

constexpr double kStart = 4.0;  // metres along the street, of robot 0

// Robot 0 drove the whole street, robot 1 a part of it, towards it.
MergeCheck check_of_part(double from, double to) {
  AgentConfig config = adaptive();
  config.adaptive.merge_check.evidence.error_rate = 1e-5;  // for which 14 m of a street are too little
  TwoRobots fleet(3, config);
  const test::BoxWorld world(3, 70.0);
  const auto map_of = [&](RobotId id, const std::vector<Pose>& truth, double drift) {
    return std::make_shared<const RobotMap>(test::drive(world, id, truth, drift));
  };
  fleet.agents[0] = Agent(map_of({0}, street(kStart, 60.0, -0.5), 0.0005), config);
  fleet.agents[1] = Agent(map_of({1}, street(to, from, 0.5), -0.0005), config);
  fleet.meet();
  EXPECT_EQ(fleet.agents[1].known().checks.size(), 1U);
  return fleet.agents[1].known().checks.at({{0}, {1}});
}

TEST(AdaptiveAgent, ADriveThatFollowsTheAdviceIsMergedWithTheEvidenceItPromised) {
  constexpr double kFrom = 36.0;
  constexpr double kTo = 50.0;
  const MergeCheck before = check_of_part(kFrom, kTo);
  ASSERT_FALSE(before.accepted) << before.reason;
  EXPECT_EQ(before.refused_kind, RefusalKind::too_little) << before.reason;
  ASSERT_TRUE(before.advice) << before.reason;
  EXPECT_NE(before.reason.find("let robot_1 drive along the path of robot_0 from"), std::string::npos)
      << before.reason;
  EXPECT_NEAR(before.advice->missing, before.needed - before.evidence, 1e-9);
  EXPECT_GE(before.advice->gain, before.advice->missing);
  EXPECT_NEAR(before.advice->from.x(), before.advice->from_m, 1.0) << "the street is straight";
  const double street_to = kStart + before.advice->to_m;
  const MergeCheck after = check_of_part(std::min(kFrom, street_to), std::max(kTo, street_to));
  EXPECT_TRUE(after.accepted) << before.reason << "\n" << after.reason;
  const double grown = after.evidence - before.evidence;
  EXPECT_GT(grown, 0.5 * before.advice->gain) << before.reason << "\n" << after.reason;
  EXPECT_LT(grown, 2.0 * before.advice->gain) << before.reason << "\n" << after.reason;
}

TEST(AdaptiveAgent, DecisionsOfOthersThatMakeNoSenseAreLeftOut) {
  TwoRobots fleet(3, adaptive());
  fleet.meet();
  const auto before = fleet.agents[0].known().checks;
  MergeCheck forged = before.begin()->second;
  forged.accepted = false;
  // Of the receiver's own decisions; by an author who is not of the pair; after a gap.
  EXPECT_TRUE(fleet.agents[0].on({{1}, {0}, MergeChecks{{0}, 0, {forged}}}).empty());
  EXPECT_TRUE(fleet.agents[0].on({{1}, {0}, MergeChecks{{2}, 0, {forged}}}).empty());
  forged.a = {2};
  forged.b = {3};
  EXPECT_TRUE(fleet.agents[0].on({{1}, {0}, MergeChecks{{2}, 5, {forged}}}).empty());
  EXPECT_EQ(fleet.agents[0].known().checks.size(), before.size());
  EXPECT_TRUE(fleet.agents[0].known().checks.begin()->second.accepted);
}

}  // namespace
}  // namespace adit

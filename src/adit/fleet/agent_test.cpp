// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/agent.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <limits>
#include <numbers>

#include "adit/core/parallel.hpp"
#include "support/box_world.hpp"

namespace adit {
namespace {

std::vector<Pose> street(double from, double to, double lane) {
  std::vector<Pose> poses;
  const double step = from < to ? 2.0 : -2.0;
  for (double x = from; (to - x) * step >= 0.0; x += step)
    poses.push_back(Pose::planar(x, lane, step > 0.0 ? 0.0 : std::numbers::pi));
  return poses;
}

AgentConfig lenient() {
  AgentConfig config;
  config.place.max_distance = 0.4;
  config.registration.voxel_size = 0.6;  // coarse, for speed: boxes of metres
  return config;
}

/// Two robots on one street, the second in the opposite direction and on the other lane.
struct TwoRobots {
  std::vector<Pose> truth_0 = street(0.0, 40.0, -0.5);
  std::vector<Pose> truth_1 = street(50.0, 14.0, 0.5);
  std::vector<Agent> agents;

  explicit TwoRobots(std::uint64_t seed = 3, const AgentConfig& config = lenient()) {
    const test::BoxWorld world(seed);
    agents.reserve(2);
    for (const auto& [id, truth] : {std::pair{0, &truth_0}, std::pair{1, &truth_1}}) {
      const auto map = std::make_shared<const RobotMap>(
          test::drive(world, {static_cast<std::uint8_t>(id)}, *truth, id == 0 ? 0.002 : -0.002));
      agents.emplace_back(map, std::make_shared<FeatureStore>(map, config.registration_in_use()), config);
    }
  }

  /// Delivers messages until all is said; `copies` of each.
  void meet(int copies = 1) {
    std::deque<Message> queue;
    const auto post = [&](const std::vector<Message>& messages) {
      for (const Message& message : messages)
        queue.insert(queue.end(), static_cast<std::size_t>(copies), message);
    };
    post(agents[0].meet({1}));
    for (int budget = 10000; !queue.empty() && budget > 0; --budget) {
      const Message message = queue.front();
      queue.pop_front();
      // Answers to a repeated Hello repeat everything; one round of that is enough for the test.
      const std::vector<Message> replies = agents[message.to.value].on(message);
      copies = 1;
      post(replies);
    }
    ASSERT_TRUE(queue.empty());
  }
};

/// A context on the grid that all robots here share.
ScanContext test_place(const TwoRobots& fleet) {
  const test::BoxWorld world(3);
  return describe(world.seen_from(fleet.truth_1.front(), 5), ScanContextConfig{.max_radius_m = 25.0});
}

TEST(Agent, TwoRobotsThatMeetAgreeOnOneCorrectMap) {
  TwoRobots fleet;
  fleet.meet();
  const FleetSolution first = fleet.agents[0].solve({});
  const FleetSolution second = fleet.agents[1].solve({});
  ASSERT_EQ(first.pairs.size(), 1U);
  ASSERT_TRUE(first.pairs[0].merged) << first.pairs[0].refused_reason;
  EXPECT_GE(first.pairs[0].clique, 3U);

  const Pose T_true = fleet.truth_0.front().inverse();  // odometry frame of robot 0
  const auto& poses_1 = first.T_world_keyframe.at({1});
  ASSERT_EQ(poses_1.size(), fleet.truth_1.size());
  for (std::size_t k = 0; k < poses_1.size(); ++k) {
    EXPECT_LT(((T_true * fleet.truth_1[k]).translation() - poses_1[k].translation()).norm(), 1.0)
        << k;  // the first ones lie 10 m beyond the last common place, where odometry alone leads
  }
  for (const LoopOutcome& outcome : first.loops) {
    if (!outcome.in_use()) continue;
    const Pose T_from_to =
        fleet.truth_0[outcome.loop.from.index].inverse() * fleet.truth_1[outcome.loop.to.index];
    EXPECT_LT((T_from_to.inverse() * outcome.loop.T_from_to).translation().norm(), 0.5);
  }
  // Both know the same, so both compute the same, to the last bit.
  for (const auto& [robot, poses] : first.T_world_keyframe) {
    for (std::size_t k = 0; k < poses.size(); ++k) {
      EXPECT_EQ(poses[k].matrix(), second.T_world_keyframe.at(robot)[k].matrix());
    }
  }
}

TEST(Agent, RepeatedMessagesChangeNothing) {
  TwoRobots once;
  once.meet();
  TwoRobots twice;
  twice.meet(2);
  twice.meet();
  ASSERT_EQ(once.agents[1].known().loops.size(), twice.agents[1].known().loops.size());
  EXPECT_GT(once.agents[1].known().loops.size(), 0U);
  EXPECT_EQ(once.agents[1].known().robots.at({0}).nodes.size(),
            twice.agents[1].known().robots.at({0}).nodes.size());
}

TEST(Agent, OneOrTwoThreadsGiveTheSameLoops) {
  set_num_threads(1);
  TwoRobots one;
  one.meet();
  set_num_threads(2);
  TwoRobots two;
  two.meet();
  ASSERT_EQ(one.agents[0].known().loops.size(), two.agents[0].known().loops.size());
  auto other = two.agents[0].known().loops.begin();
  for (const auto& [ends, loop] : one.agents[0].known().loops) {
    EXPECT_EQ(ends, other->first);
    EXPECT_EQ(loop.T_from_to.matrix(), other->second.T_from_to.matrix());
    EXPECT_EQ(loop.num_inliers, other->second.num_inliers);
    ++other;
  }
}

TEST(Agent, KnowsNothingOfARobotItNeverMet) {
  TwoRobots fleet;
  EXPECT_EQ(fleet.agents[0].known().robots.size(), 1U);
  const FleetSolution alone = fleet.agents[0].solve({});
  ASSERT_EQ(alone.components.size(), 1U);
  EXPECT_EQ(alone.components[0].robots, std::vector<RobotId>{{0}});
  EXPECT_TRUE(alone.pairs.empty());
}

TEST(Agent, MessageForAnotherRobotIsABug) {
  TwoRobots fleet;
  EXPECT_THROW((void)fleet.agents[0].on(Message{{1}, {7}, Loops{}}), ContractViolation);
}

TEST(Agent, RequestForAKeyframeThatDoesNotExistIsAnsweredWithLess) {
  TwoRobots fleet;
  const std::vector<Message> replies = fleet.agents[0].on(Message{{1}, {0}, CloudRequest{{0, 999999}}});
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(std::get<Clouds>(replies[0].body).clouds.size(), 1U);
}

TEST(Agent, EchoOfItsOwnMessageIsNotAnswered) {
  TwoRobots fleet;
  EXPECT_TRUE(fleet.agents[0].on(Message{{0}, {0}, Hello{}}).empty());
}

TEST(Agent, RobotWithoutKeyframesIsStillMadeKnown) {
  RobotMap nothing;
  nothing.id = {1};
  nothing.name = "robot_1";
  const auto map = std::make_shared<const RobotMap>(nothing);
  TwoRobots fleet;
  fleet.agents[1] = Agent(map, std::make_shared<FeatureStore>(map, lenient().registration), lenient());
  fleet.meet();
  for (const Agent& agent : fleet.agents) {
    const FleetSolution solution = agent.solve({});
    ASSERT_EQ(solution.pairs.size(), 1U);
    EXPECT_NE(solution.pairs[0].refused_reason.find("left no keyframe of robot_1"), std::string::npos);
  }
}

TEST(Agent, PlacesOnAnotherGridAreLeftOut) {
  TwoRobots fleet;
  const std::vector<float> heights(8 * 12, 1.0F);
  const ScanContext other = from_heights(8, 12, heights);
  Places mixed{0, {{0, test_place(fleet)}, {1, other}}, true};
  EXPECT_TRUE(fleet.agents[0].on(Message{{1}, {0}, mixed}).empty());
  EXPECT_TRUE(fleet.agents[0].on(Message{{1}, {0}, Places{0, {{2, ScanContext{}}}, true}}).empty());
  fleet.meet();
  EXPECT_TRUE(fleet.agents[0].solve({}).pairs.at(0).merged);
}

TEST(Agent, PlacesAndCloudsOfKeyframesThatDoNotExistAreHarmless) {
  TwoRobots fleet;
  const Places invented{0, {{4'000'000'000U, test_place(fleet)}}, true};
  EXPECT_NO_THROW((void)fleet.agents[0].on(Message{{1}, {0}, invented}));
  EXPECT_TRUE(fleet.agents[0].on(Message{{1}, {0}, Clouds{{{123456, Eigen::Vector3f::Zero(), {}}}}}).empty());
  EXPECT_TRUE(fleet.agents[1].on(Message{{0}, {1}, invented}).empty());  // robot 1 does not search robot 0
  fleet.meet();
  EXPECT_TRUE(fleet.agents[1].solve({}).pairs.at(0).merged);
}

TEST(Agent, LoopsThatNameNobodyDoNotHarmTheSolution) {
  TwoRobots fleet;
  fleet.meet();
  const FleetSolution before = fleet.agents[0].solve({});
  LoopClosure loop;
  loop.verdict = LoopVerdict::accepted;
  Loops invented;
  for (const auto& [from, to] : std::vector<std::pair<KeyframeId, KeyframeId>>{{{{0}, 1}, {{1}, 999999}},
                                                                               {{{0}, 999999}, {{1}, 1}},
                                                                               {{{0}, 1}, {{9}, 1}},
                                                                               {{{1}, 3}, {{0}, 2}},
                                                                               {{{0}, 2}, {{0}, 2}}}) {
    loop.from = from;
    loop.to = to;
    invented.loops.push_back(loop);
  }
  EXPECT_TRUE(fleet.agents[0].on(Message{{1}, {0}, invented}).empty());
  const FleetSolution after = fleet.agents[0].solve({});
  EXPECT_EQ(after.loops.size(), before.loops.size());
  for (const auto& [robot, poses] : before.T_world_keyframe) {
    for (std::size_t k = 0; k < poses.size(); ++k) {
      EXPECT_EQ(poses[k].matrix(), after.T_world_keyframe.at(robot)[k].matrix());
    }
  }
}

TEST(Agent, GraphWithoutUsableCovariancesIsLeftOut) {
  TwoRobots fleet;
  for (const double variance : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    GraphNode node;
    node.step_covariance = Matrix6::Identity() * variance;
    EXPECT_TRUE(fleet.agents[0].on(Message{{2}, {0}, GraphPart{{2}, "odd", 0, {node, node}}}).empty());
    EXPECT_FALSE(fleet.agents[0].known().robots.contains({2}));
  }
}

TEST(Agent, GraphPartAfterALostOneWaitsForIt) {
  TwoRobots fleet;
  GraphNode node;
  node.step_covariance = Matrix6::Identity() * 0.01;
  const auto send = [&](std::uint32_t first) {
    (void)fleet.agents[0].on(Message{{2}, {0}, GraphPart{{2}, "late", first, {node, node}}});
  };
  send(2);
  EXPECT_FALSE(fleet.agents[0].known().robots.contains({2}));
  send(0);
  send(1);  // overlaps what is known
  EXPECT_EQ(fleet.agents[0].known().robots.at({2}).nodes.size(), 3U);
}

TEST(Agent, RegistersTheMostSimilarCandidatesWhereItMayNotRegisterAll) {
  TwoRobots all;
  all.meet();
  AgentConfig config = lenient();
  config.max_candidates = 0;
  config.candidates_per_peer = 2;
  TwoRobots few(3, config);
  few.meet();
  ASSERT_GT(all.agents[0].known().loops.size(), 4U);
  ASSERT_EQ(few.agents[0].known().loops.size(), 2U);
  // It looks with every fourth keyframe, and of what it finds takes the best.
  double best = std::numeric_limits<double>::infinity();
  for (const auto& [ends, loop] : all.agents[0].known().loops)
    if (ends.first.index % 4 == 0) best = std::min(best, loop.place_distance);
  double best_of_few = std::numeric_limits<double>::infinity();
  for (const auto& [ends, loop] : few.agents[0].known().loops) {
    EXPECT_EQ(ends.first.index % 4, 0U);
    best_of_few = std::min(best_of_few, loop.place_distance);
  }
  EXPECT_EQ(best_of_few, best);
}

AgentConfig adaptive() {
  AgentConfig config;
  config.adaptive.on = true;
  config.adaptive.registration.voxel_size = 0.6;
  config.adaptive.merge_check.error_rate = 0.3;  // a street of 25 m is short
  config.adaptive.merge_check.spacing_m = 2.0;
  config.adaptive.merge_check.discernment.samples = 8;
  config.adaptive.context = {.max_radius_m = 25.0};
  return config;
}

BackEndConfig with_checks() {
  BackEndConfig config;
  config.checks_needed = true;
  return config;
}

TEST(AdaptiveAgent, MergesRobotsThatShareAStreetAndBothKnowWhy) {
  TwoRobots fleet(3, adaptive());
  fleet.meet();
  const FleetSolution first = fleet.agents[0].solve(with_checks());
  const FleetSolution second = fleet.agents[1].solve(with_checks());
  ASSERT_TRUE(first.pairs[0].merged) << first.pairs[0].refused_reason;
  const MergeCheck& check = fleet.agents[1].known().checks.at({{0}, {1}});
  EXPECT_TRUE(check.accepted);
  EXPECT_GE(check.evidence, check.needed);
  EXPECT_EQ(check.loops.size(), first.pairs[0].clique);
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
  fleet.agents[1] =
      Agent(map, std::make_shared<FeatureStore>(map, adaptive().registration_in_use()), adaptive());
  fleet.meet();
  const FleetSolution solution = fleet.agents[0].solve(with_checks());
  EXPECT_FALSE(solution.pairs[0].merged);
  EXPECT_FALSE(solution.pairs[0].refused_reason.empty());
  EXPECT_EQ(solution.components.size(), 2U);
}

/// A robot that drives up the street and back again, on the other lane.
struct ThereAndBack {
  std::vector<Pose> truth = street(0.0, 50.0, -0.5);
  std::shared_ptr<const RobotMap> map;

  explicit ThereAndBack(double yaw_drift = 0.003) {
    for (const Pose& pose : street(50.0, 0.0, 0.5)) truth.push_back(pose);
    map = std::make_shared<const RobotMap>(test::drive(test::BoxWorld(3), {0}, truth, yaw_drift));
  }
  [[nodiscard]] Agent agent(const AgentConfig& config = adaptive()) const {
    return {map, std::make_shared<FeatureStore>(map, config.registration_in_use()), config};
  }
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
  const double before = robot.largest_error(agent.solve(with_checks()));
  agent.find_revisits();
  const FleetSolution solution = agent.solve(with_checks());
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
  EXPECT_LE(agent.known().loops.size(), static_cast<std::size_t>(adaptive().adaptive.revisit_candidates));
}

TEST(AdaptiveAgent, FindsNoRevisitWhereItNeverCameBackOrMayNotLook) {
  TwoRobots fleet(3, adaptive());
  fleet.agents[0].find_revisits();
  EXPECT_TRUE(fleet.agents[0].known().loops.empty());
  EXPECT_TRUE(fleet.agents[0].known().checks.empty());
  AgentConfig config = adaptive();
  config.adaptive.revisits = false;
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
  const FleetSolution first = fleet.agents[0].solve(with_checks());
  const FleetSolution second = fleet.agents[1].solve(with_checks());
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

TEST(AdaptiveAgent, ATestWaitsForAGraphThatWasLost) {
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
  EXPECT_GT(fleet.agents[0].known().loops.size(), 0U);
  EXPECT_TRUE(fleet.agents[0].known().checks.empty());
  meet(false);
  ASSERT_EQ(fleet.agents[1].known().checks.size(), 1U);
  EXPECT_TRUE(fleet.agents[0].known().checks.begin()->second.accepted);
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

TEST(FeatureStore, ForgetsWhatWasUsedLongestAgoAndKeepsItsBound) {
  const test::BoxWorld world(3);
  const auto map = std::make_shared<const RobotMap>(test::drive(world, {0}, street(0.0, 20.0, 0.0), 0.0));
  const RegistrationConfig config = lenient().registration;
  FeatureStore measure(map, config);
  measure.prepare({0, 1});
  FeatureStore store(map, config, measure.num_bytes());  // room for two or so
  store.prepare({0});
  store.prepare({1});
  const Features first = store.at(1);
  for (std::uint32_t i = 2; i < 8; ++i) {
    store.prepare({1, i});
    EXPECT_NO_THROW((void)store.at(i));
  }
  EXPECT_THROW((void)store.at(0), ContractViolation);
  EXPECT_EQ(store.at(1).points, first.points);
  store.prepare({0, 1, 2, 3});  // what is asked for at once is there, whatever the bound
  for (const std::uint32_t i : {0U, 1U, 2U, 3U}) EXPECT_NO_THROW((void)store.at(i));
  store.prepare({5});
  EXPECT_LE(store.num_bytes(), measure.num_bytes());
}

}  // namespace
}  // namespace adit

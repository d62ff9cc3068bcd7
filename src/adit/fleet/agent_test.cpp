// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/agent.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <stdexcept>

#include "adit/core/parallel.hpp"
#include "support/two_robots.hpp"

namespace adit {
namespace {

using test::lenient;
using test::street;
using test::TwoRobots;

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
  EXPECT_GE(first.pairs[0].num_selected, 3U);

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
  fleet.agents[1] = Agent(map, lenient());
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
  EXPECT_EQ(fleet.agents[0].num_left_out(), 2U);
  fleet.meet();
  EXPECT_TRUE(fleet.agents[0].solve({}).pairs.at(0).merged);
}

TEST(Agent, ARobotWhoseDescriptorsAreLostOrOnAnotherGridWasNotSearched) {
  const std::vector<float> heights(8 * 12, 1.0F);
  const Places other{0, {{0, from_heights(8, 12, heights)}}, true};
  for (const bool on_another_grid : {false, true}) {
    TwoRobots fleet;
    for (const Message& answer : fleet.agents[1].on(fleet.agents[0].meet({1}).front()))
      if (!std::holds_alternative<Places>(answer.body)) (void)fleet.agents[0].on(answer);
    if (on_another_grid) (void)fleet.agents[0].on({{1}, {0}, other});
    const FleetSolution apart = fleet.agents[0].solve({});
    const std::string& reason = apart.pairs.at(0).refused_reason;
    EXPECT_EQ(reason.find("resembled"), std::string::npos) << reason;
    EXPECT_NE(reason.find(on_another_grid ? "another grid" : "robot_0 has not searched robot_1"),
              std::string::npos)
        << reason;
    fleet.meet();
    EXPECT_TRUE(fleet.agents[0].known().unsearched.empty());
    EXPECT_TRUE(fleet.agents[0].solve({}).pairs.at(0).merged);
  }
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

TEST(FeatureStore, ForgetsWhatWasUsedLongestAgoAndKeepsItsBound) {
  const test::BoxWorld world(3);
  const auto map = std::make_shared<const RobotMap>(test::drive(world, {0}, street(0.0, 20.0, 0.0), 0.0));
  const RegistrationConfig config = lenient().registration;
  FeatureStore measure(map, config, {});
  measure.prepare({0, 1});
  FeatureStore store(map, config, {}, measure.num_bytes());  // room for two or so
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

TEST(KeyframeStore, WhereOneCannotBeComputedNoneIsKeptThatIsNotCounted) {
  const test::BoxWorld world(3);
  const auto map = std::make_shared<const RobotMap>(test::drive(world, {0}, street(0.0, 20.0, 0.0), 0.0));
  std::atomic<bool> fails = true;
  KeyframeStore<std::uint32_t> store(
      map,
      [&](const RobotMap&, std::uint32_t index) {
        if (index == 3 && fails) throw std::runtime_error("no memory");
        return index;
      },
      [](std::uint32_t) { return std::size_t{10}; }, 20);
  EXPECT_THROW(store.prepare({0, 1, 2, 3}), std::runtime_error);
  fails = false;
  store.prepare({4, 5, 6});
  EXPECT_EQ(store.num_bytes(), 30U);
  store.prepare({0, 3});
  EXPECT_EQ(store.num_bytes(), 20U);
  EXPECT_EQ(store.at(3), 3U);
}

TEST(Agent, PlacesThatBringNothingEndNoTransfer) {
  TwoRobots fleet;
  Agent& agent = fleet.agents[0];
  const Places::Place place{0, test_place(fleet)};
  const auto num_received = [&](RobotId of) {
    const Hello hello = std::get<Hello>(agent.meet(of).front().body);
    const auto known = std::ranges::find(hello.known, of, &Hello::Known::robot);
    return known == hello.known.end() ? 0U : known->num_places;
  };
  for (const RobotId peer : {RobotId{1}, RobotId{2}})
    (void)agent.on({peer, {0}, Hello{{{peer, 20, 0, 0, 0}}, true}});
  EXPECT_TRUE(agent.on({{1}, {0}, Places{0, {place}, false}}).empty());
  EXPECT_TRUE(agent.on({{2}, {0}, Places{5, {place}, true}}).empty()) << "a part before it was lost";
  EXPECT_TRUE(agent.on({{2}, {0}, Places{0, {}, true}}).empty());
  EXPECT_EQ(num_received({1}), 1U);
  EXPECT_TRUE(agent.on({{2}, {0}, Places{0, {place}, false}}).empty());
  EXPECT_EQ(num_received({1}), 0U) << "one transfer at a time";
  EXPECT_EQ(num_received({2}), 1U);
}

}  // namespace
}  // namespace adit

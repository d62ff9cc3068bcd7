// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Whatever breaks an agent's work off costs a meeting, not the pair.
#include <gtest/gtest.h>

#include <deque>
#include <variant>

#include "adit/fleet/agent.hpp"
#include "support/cancel_after.hpp"
#include "support/two_robots.hpp"

namespace adit {
namespace {

using test::adaptive;
using test::CancelAfter;
using test::street;
using test::TwoRobots;

/// Delivers messages until none is left; where `lose` says so, one is lost. False where robot 0 was stopped.
template <class Lose>
bool meet(TwoRobots& fleet, ProgressObserver& observer, const Lose& lose) {
  std::deque<Message> queue;
  for (const Message& message : fleet.agents[0].meet({1})) queue.push_back(message);
  const ObserverScope scope(observer);
  for (int budget = 10000; !queue.empty() && budget > 0; --budget) {
    const Message message = queue.front();
    queue.pop_front();
    if (lose(message)) continue;
    try {
      for (const Message& reply : fleet.agents[message.to.value].on(message)) queue.push_back(reply);
    } catch (const Cancelled&) {
      return false;
    }
  }
  return true;
}

bool meet(TwoRobots& fleet, ProgressObserver& observer) {
  return meet(fleet, observer, [](const Message&) { return false; });
}

TEST(InterruptedAgent, AMeetingThatIsBrokenOffAnywhereIsMadeUpForByTheNext) {
  TwoRobots whole(3, adaptive());
  CancelAfter never;
  ASSERT_TRUE(meet(whole, never));
  const MergeCheck expected = whole.agents[0].known().checks.at({{0}, {1}});
  EXPECT_EQ(whole.agents[0].num_left_out() + whole.agents[1].num_left_out(), 0U);
  for (const double share : {0.05, 0.3, 0.6, 0.95}) {
    const auto num_polls = static_cast<std::size_t>(share * static_cast<double>(never.num_polled()));
    TwoRobots fleet(3, adaptive());
    CancelAfter observer(num_polls);
    EXPECT_FALSE(meet(fleet, observer)) << share;
    CancelAfter again;
    ASSERT_TRUE(meet(fleet, again));
    const FleetGraph& known = fleet.agents[0].known();
    EXPECT_EQ(known.loops.size(), whole.agents[0].known().loops.size()) << share;
    ASSERT_EQ(known.checks.size(), 1U) << share;
    EXPECT_EQ(known.checks.at({{0}, {1}}).evidence, expected.evidence) << share;
    EXPECT_EQ(known.checks.at({{0}, {1}}).reason, expected.reason) << share;
    EXPECT_TRUE(known.unsearched.empty()) << share;
  }
}

TEST(InterruptedAgent, LooksForRevisitsAgainWhereItWasStopped) {
  std::vector<Pose> truth = street(0.0, 50.0, -0.5);
  for (const Pose& pose : street(50.0, 0.0, 0.5)) truth.push_back(pose);
  const auto map = std::make_shared<const RobotMap>(test::drive(test::BoxWorld(3), {0}, truth, 0.003));
  CancelAfter never;
  Agent whole(map, adaptive());
  {
    const ObserverScope scope(never);
    whole.find_revisits();
  }
  const MergeCheck expected = whole.known().checks.at({{0}, {0}});
  for (const double share : {0.01, 0.9}) {
    Agent agent(map, adaptive());
    {
      CancelAfter observer(static_cast<std::size_t>(share * static_cast<double>(never.num_polled())));
      const ObserverScope scope(observer);
      EXPECT_THROW(agent.find_revisits(), Cancelled) << share;
    }
    agent.find_revisits();
    EXPECT_EQ(agent.known().loops.size(), whole.known().loops.size()) << share;
    ASSERT_EQ(agent.known().checks.size(), 1U) << share;
    EXPECT_EQ(agent.known().checks.at({{0}, {0}}).evidence, expected.evidence) << share;
  }
}

// The peer is repaired, and comes back with less of its map than the check was planned on.
TEST(InterruptedAgent, AComparisonOfKeyframesThatThePeerHasNoLongerIsPlannedAnew) {
  TwoRobots fleet(3, adaptive());
  CancelAfter never;
  meet(fleet, never, [](const Message& message) {
    const auto* clouds = std::get_if<Clouds>(&message.body);
    return clouds != nullptr && clouds->kind == CloudKind::view;
  });
  ASSERT_TRUE(fleet.agents[0].known().checks.empty());
  std::vector<Pose> truth = fleet.truth_1;
  truth.resize(truth.size() - 3);  // those that stand in the shared part of the street
  const auto map = std::make_shared<const RobotMap>(test::drive(test::BoxWorld(3), {1}, truth, -0.002));
  fleet.agents[1] = Agent(map, adaptive());
  meet(fleet, never);
  const FleetGraph& known = fleet.agents[0].known();
  ASSERT_EQ(known.checks.size(), 1U);
  for (const auto& [own, theirs] : known.checks.at({{0}, {1}}).loops) EXPECT_LT(theirs, truth.size());
}

// The peer drives on, and is repaired in the middle of the second check. The verdict of the first check does
// not know the loops that were found since, so that the second is due.
TEST(InterruptedAgent, ACheckOfAMapThatHasGrownIsMadeUpForToo) {
  TwoRobots fleet(3, adaptive());
  const auto peer_after = [&](std::size_t num_poses) {
    const std::vector<Pose> truth(fleet.truth_1.begin(),
                                  fleet.truth_1.begin() + static_cast<std::ptrdiff_t>(num_poses));
    return Agent(std::make_shared<const RobotMap>(test::drive(test::BoxWorld(3), {1}, truth, -0.002)),
                 adaptive());
  };
  const auto verdict = [&] { return fleet.agents[0].known().checks.at({{0}, {1}}); };
  const std::size_t num_poses = fleet.truth_1.size();
  CancelAfter never;
  fleet.agents[1] = peer_after(num_poses - 6);
  meet(fleet, never);
  const MergeCheck first = verdict();
  fleet.agents[1] = peer_after(num_poses);
  meet(fleet, never, [](const Message& message) {
    const auto* clouds = std::get_if<Clouds>(&message.body);
    return clouds != nullptr && clouds->kind == CloudKind::view;
  });
  EXPECT_EQ(verdict().loops, first.loops);
  fleet.agents[1] = peer_after(num_poses - 3);
  meet(fleet, never);
  EXPECT_GT(verdict().loops.size(), first.loops.size());
}

}  // namespace
}  // namespace adit

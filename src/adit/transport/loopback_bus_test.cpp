// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/transport/loopback_bus.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <limits>

#include "adit/core/rng.hpp"
#include "support/box_world.hpp"
#include "support/wire.hpp"

namespace adit {
namespace {

/// `num` robots one behind the other on one street.
std::vector<Agent> robots_on_a_street(int num, MergePolicy policy = MergePolicy::paper) {
  const test::BoxWorld world(11);
  AgentConfig config;
  config.policy = policy;
  config.place.max_distance = 0.4;
  config.registration.voxel_size = 0.6;  // coarse, for speed: boxes of metres
  config.adaptive.registration.voxel_size = 0.6;
  config.adaptive.merge_check.discernment.samples = 8;
  std::vector<Agent> agents;
  agents.reserve(static_cast<std::size_t>(num));
  for (int r = 0; r < num; ++r) {
    std::vector<Pose> truth;
    for (double x = 4.0 * r; x < 4.0 * r + 24.0; x += 2.0) truth.push_back(Pose::planar(x, 0.3 * r, 0.0));
    const auto map =
        std::make_shared<const RobotMap>(test::drive(world, {static_cast<std::uint8_t>(r)}, truth, 0.0));
    agents.emplace_back(map, config);
  }
  return agents;
}

void join_all(std::vector<Agent>& agents, LoopbackBus& bus) {
  for (Agent& agent : agents) bus.join(agent);
}

TEST(LoopbackBus, CarriesAMeetingAndCountsItsBytes) {
  std::vector<Agent> agents = robots_on_a_street(2);
  LoopbackBus bus;
  join_all(agents, bus);
  ASSERT_TRUE(bus.meet({0}, {1}).has_value());
  EXPECT_EQ(agents[0].known().loops.size(), agents[1].known().loops.size());
  EXPECT_GT(agents[0].known().loops.size(), 0U);
  EXPECT_GT(bus.bytes_sent({1}), bus.bytes_sent({0}));  // the one with the larger id sends clouds
  EXPECT_EQ(bus.bytes_sent({9}), 0U);
  EXPECT_EQ(bus.num_lost(), 0);
  EXPECT_TRUE(bus.failures().empty());
}

TEST(LoopbackBus, AMessageThatFailsIsNotedAndStopsNobody) {
  std::vector<Agent> agents = robots_on_a_street(2);
  RobotMap broken = test::drive(test::BoxWorld(11), {1}, {Pose(), Pose::planar(2.0, 0.0, 0.0)}, 0.0);
  broken.step_covariances[1](0, 0) = std::numeric_limits<double>::quiet_NaN();
  AgentConfig config;
  config.policy = MergePolicy::paper;
  agents[1] = Agent(std::make_shared<const RobotMap>(broken), config);
  LoopbackBus bus;
  join_all(agents, bus);
  ASSERT_TRUE(bus.meet({0}, {1}).has_value());
  ASSERT_EQ(bus.failures().size(), 1U);
  EXPECT_EQ(bus.failures()[0].find("message to robot 0: message of kind 1 is malformed"), 0U)
      << bus.failures()[0];
  EXPECT_EQ(agents[1].known().robots.size(), 2U) << "what the other one said has arrived";
}

TEST(LoopbackBus, ASecondMeetingSendsNothingAnew) {
  std::vector<Agent> agents = robots_on_a_street(2);
  LoopbackBus bus;
  join_all(agents, bus);
  ASSERT_TRUE(bus.meet({0}, {1}).has_value());
  const std::uint64_t before = bus.bytes_sent({1});
  ASSERT_TRUE(bus.meet({0}, {1}).has_value());
  EXPECT_LT(bus.bytes_sent({1}) - before, 200U);
}

TEST(LoopbackBus, LostMessagesAreMadeUpForByLaterMeetings) {
  std::vector<Agent> reliable = robots_on_a_street(2);
  LoopbackBus good;
  join_all(reliable, good);
  ASSERT_TRUE(good.meet({0}, {1}).has_value());

  std::vector<Agent> agents = robots_on_a_street(2);
  LoopbackBus bad({.loss = 0.3, .seed = 4});
  join_all(agents, bad);
  for (int meeting = 0; meeting < 20; ++meeting) ASSERT_TRUE(bad.meet({0}, {1}).has_value());
  EXPECT_GT(bad.num_lost(), 0);
  ASSERT_EQ(agents[1].known().loops.size(), reliable[1].known().loops.size());
  const FleetSolution expected = reliable[0].solve({});
  const FleetSolution solution = agents[1].solve({});
  for (const auto& [robot, poses] : expected.T_world_keyframe) {
    for (std::size_t k = 0; k < poses.size(); ++k) {
      EXPECT_EQ(poses[k].matrix(), solution.T_world_keyframe.at(robot)[k].matrix());
    }
  }
}

TEST(LoopbackBus, NewsTravelOverARobotInBetween) {
  std::vector<Agent> agents = robots_on_a_street(3);
  LoopbackBus bus;
  join_all(agents, bus);
  ASSERT_TRUE(bus.meet({1}, {2}).has_value());
  ASSERT_TRUE(bus.meet({0}, {1}).has_value());
  const FleetGraph& known = agents[0].known();  // never met robot 2
  ASSERT_TRUE(known.robots.contains({2}));
  EXPECT_EQ(known.robots.at({2}).nodes.size(), 12U);
  const FleetSolution solution = agents[0].solve({});
  EXPECT_EQ(solution.components.size(), 1U);
}

/// All messages of one meeting, in order, as bytes.
std::vector<std::vector<std::byte>> recorded_meeting(std::vector<Agent>& agents) {
  std::vector<std::vector<std::byte>> recorded;
  std::deque<Message> queue;
  const auto post = [&](const std::vector<Message>& messages) {
    queue.insert(queue.end(), messages.begin(), messages.end());
  };
  post(agents[0].meet({1}));
  for (; !queue.empty(); queue.pop_front()) {
    recorded.push_back(encode(queue.front()));
    post(agents[queue.front().to.value].on(queue.front()));
  }
  return recorded;
}

class Nonsense : public ::testing::TestWithParam<MergePolicy> {};

TEST_P(Nonsense, InAValidMessageNeverStopsAnAgent) {
  std::vector<Agent> sane = robots_on_a_street(2, GetParam());
  const std::vector<std::vector<std::byte>> messages = recorded_meeting(sane);
  ASSERT_EQ(sane[1].known().checks.size(), GetParam() == MergePolicy::adaptive ? 1U : 0U);
  std::vector<Agent> agents = robots_on_a_street(2, GetParam());
  Rng rng(8);
  int num_taken = 0;
  for (int trial = 0; trial < 8; ++trial) {
    for (std::vector<std::byte> bytes : messages) {
      for (int i = 0; i < 3; ++i) {
        const std::size_t at = 3 + rng.below(std::min<std::size_t>(bytes.size() - 11, 400));
        bytes[at] = static_cast<std::byte>(rng.below(256));
      }
      const Result<Message> nonsense = decode(test::resealed(bytes));
      if (!nonsense.has_value()) continue;
      ++num_taken;
      EXPECT_NO_THROW((void)agents[nonsense->to.value].on(*nonsense));
    }
  }
  EXPECT_GT(num_taken, 30);
  for (const Agent& agent : agents) EXPECT_NO_THROW((void)agent.solve({}));
}

INSTANTIATE_TEST_SUITE_P(Policies, Nonsense, ::testing::Values(MergePolicy::paper, MergePolicy::adaptive));

TEST(LoopbackBus, UnknownRobotIsAnError) {
  LoopbackBus bus;
  const Result<> met = bus.meet({0}, {1});
  ASSERT_FALSE(met.has_value());
  EXPECT_NE(met.error().message.find("not on the bus"), std::string::npos);
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Two agents that meet on a made-up street, for tests of their messages.
#pragma once

#include <gtest/gtest.h>

#include <deque>
#include <memory>
#include <numbers>
#include <utility>
#include <vector>

#include "adit/fleet/agent.hpp"
#include "support/box_world.hpp"

namespace adit::test {

inline std::vector<Pose> street(double from, double to, double lane) {
  std::vector<Pose> poses;
  const double step = from < to ? 2.0 : -2.0;
  for (double x = from; (to - x) * step >= 0.0; x += step)
    poses.push_back(Pose::planar(x, lane, step > 0.0 ? 0.0 : std::numbers::pi));
  return poses;
}

/// The paper's policy, with thresholds that boxes pass.
inline AgentConfig lenient() {
  AgentConfig config;
  config.policy = MergePolicy::paper;
  config.place.max_distance = 0.4;
  config.registration.voxel_size = 0.6;  // coarse, for speed: boxes of metres
  return config;
}

/// The default policy, on so little that a street of boxes decides.
inline AgentConfig adaptive() {
  AgentConfig config;
  config.adaptive.registration.voxel_size = 0.6;
  config.adaptive.merge_check.evidence.error_rate = 0.3;  // a street of 25 m is short
  config.adaptive.merge_check.spacing_m = 2.0;
  config.adaptive.merge_check.discernment.samples = 8;
  // The boxes are transparent: faces mix within a voxel, and the surface hangs on the grid.
  config.adaptive.merge_check.relief = false;
  return config;
}

/// Two robots on one street, the second in the opposite direction and on the other lane.
struct TwoRobots {
  std::vector<Pose> truth_0 = street(0.0, 40.0, -0.5);
  std::vector<Pose> truth_1 = street(50.0, 14.0, 0.5);
  std::vector<Agent> agents;

  explicit TwoRobots(std::uint64_t seed = 3, const AgentConfig& config = lenient()) {
    const BoxWorld world(seed);
    agents.reserve(2);
    for (const auto& [id, truth] : {std::pair{0, &truth_0}, std::pair{1, &truth_1}}) {
      const auto map = std::make_shared<const RobotMap>(
          drive(world, {static_cast<std::uint8_t>(id)}, *truth, id == 0 ? 0.002 : -0.002));
      agents.emplace_back(map, config);
    }
  }

  /// Delivers messages until none is left; `copies` of each.
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

}  // namespace adit::test

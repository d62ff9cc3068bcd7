// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// From recordings to a joint map, as `adit slam` does it, for scenario tests.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "adit/evaluation/loop_stats.hpp"
#include "adit/robot/robot_slam.hpp"
#include "adit/transport/loopback_bus.hpp"

namespace adit::test {

struct Joint {
  std::vector<std::shared_ptr<const RobotMap>> maps;
  FleetGraph fleet;
  FleetSolution solution;
};

/// Loops join maps without a merge check.
inline AgentConfig paper() {
  AgentConfig config;
  config.policy = MergePolicy::paper;
  return config;
}

/// Maps each recording, lets the two robots meet and solves what the first then knows.
inline Joint map_and_meet(const std::vector<Recording>& recordings, const RobotSlamConfig& config,
                          const AgentConfig& loops = {}, const BackEndConfig& back_end = {}) {
  Joint joint;
  std::vector<Agent> agents;
  agents.reserve(recordings.size());
  LoopbackBus bus;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    const Result<RobotMap> map = map_recording(recordings[i], {static_cast<std::uint8_t>(i)}, config);
    EXPECT_TRUE(map.has_value()) << map.error().message;
    if (!map) return joint;
    joint.maps.push_back(std::make_shared<const RobotMap>(*map));
    agents.emplace_back(joint.maps.back(), loops);
    bus.join(agents.back());
  }
  EXPECT_TRUE(bus.meet({0}, {1}).has_value());
  joint.fleet = agents[0].known();
  joint.solution = agents[0].solve(back_end);
  return joint;
}

/// The true T_from_to of a loop.
inline Pose true_loop(const LoopClosure& loop, const Joint& joint, const std::vector<Recording>& recordings) {
  const auto truth_of = [&](KeyframeId id) {
    const Keyframe& keyframe = joint.maps[id.robot.value]->keyframes[id.index];
    return pose_at(recordings[id.robot.value].truth, keyframe.stamp).value();
  };
  return truth_of(loop.from).inverse() * truth_of(loop.to);
}

/// The loops in use, judged by the true poses.
inline LoopCounts loops_in_use(const Joint& joint, const std::vector<Recording>& recordings) {
  LoopCounts counts;
  for (const LoopOutcome& outcome : joint.solution.loops)
    if (outcome.in_use())
      counts.add(classify(outcome.loop, Pose(), true_loop(outcome.loop, joint, recordings)));
  return counts;
}

inline std::vector<Trajectory> joint_trajectories(const Joint& joint) {
  std::vector<Trajectory> trajectories;
  for (const auto& map : joint.maps) {
    Trajectory& trajectory = trajectories.emplace_back();
    const std::vector<Pose>& poses = joint.solution.T_world_keyframe.at(map->id);
    for (std::size_t k = 0; k < poses.size(); ++k) {
      trajectory.push_back({map->keyframes[k].stamp, poses[k]});
    }
  }
  return trajectories;
}

}  // namespace adit::test

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Graphs of robots that drive in circles, with true poses and no clouds.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "adit/fleet/joint/fleet_solution.hpp"
#include "adit/odometry/path_uncertainty.hpp"
#include "adit/robot/robot_map.hpp"
#include "support/loop_information.hpp"

namespace adit::test {

inline constexpr std::uint32_t kNodes = 40;

inline Pose true_pose(RobotId robot, std::uint32_t k) {
  // Robots on slightly different circles: every pose differs, and each robot starts elsewhere.
  const double angle = 0.06 * k + 0.4 * robot.value;
  return Pose::planar((20.0 + robot.value) * std::sin(angle), -(20.0 + robot.value) * std::cos(angle), angle,
                      0.0);
}

/// Under MergePolicy::paper their loops join them without a merge check.
inline FleetGraph robots_without_loops(int num_robots, MergePolicy policy = MergePolicy::adaptive) {
  FleetGraph fleet;
  fleet.policy = policy;
  for (std::uint8_t r = 0; r < num_robots; ++r) {
    RobotGraph& graph = fleet.robots[{r}];
    graph.name = "robot_" + std::to_string(r);
    for (std::uint32_t k = 0; k < kNodes; ++k) {
      const Pose T_odom_base = true_pose({r}, 0).inverse() * true_pose({r}, k);
      const double step = k == 0 ? 0.0 : 1.2;
      graph.nodes.push_back(
          {Stamp{k}, T_odom_base, k == 0 ? Matrix6(Matrix6::Zero()) : random_walk({}, step)});
    }
  }
  return fleet;
}

inline void add_loop(FleetGraph& fleet, KeyframeId from, KeyframeId to, const Pose& error = {}) {
  LoopClosure loop;
  loop.from = from;
  loop.to = to;
  loop.T_from_to = true_pose(from.robot, from.index).inverse() * true_pose(to.robot, to.index) * error;
  loop.information = loop_information();
  loop.verdict = LoopVerdict::accepted;
  fleet.loops[{from, to}] = loop;
}

inline double largest_error(const FleetSolution& solution, const Component& component) {
  const Pose T_frame_world = true_pose(component.anchor, 0).inverse();
  double worst = 0.0;
  for (const RobotId robot : component.robots) {
    for (std::uint32_t k = 0; k < kNodes; ++k) {
      const Vector3 expected = (T_frame_world * true_pose(robot, k)).translation();
      worst = std::max(worst, (solution.T_world_keyframe.at(robot)[k].translation() - expected).norm());
    }
  }
  return worst;
}

}  // namespace adit::test

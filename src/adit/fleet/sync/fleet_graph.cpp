// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/sync/fleet_graph.hpp"

#include <numbers>

namespace adit {

RobotGraph graph_of(const RobotMap& map) {
  RobotGraph graph{map.name, {}};
  graph.nodes.reserve(map.keyframes.size());
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    graph.nodes.push_back({map.keyframes[k].stamp, map.keyframes[k].T_odom_base, map.step_covariances[k]});
  }
  return graph;
}

Matrix6 loop_information(const LoopNoise& noise) {
  const double rotation = noise.rotation_deg * std::numbers::pi / 180.0;
  Vector6 information;
  information << Vector3::Constant(1.0 / (noise.translation * noise.translation)),
      Vector3::Constant(1.0 / (rotation * rotation));
  return information.asDiagonal();
}

PcmLoop pcm_loop_of(const LoopClosure& loop, const LoopNoise& noise) {
  return {loop.from.index, loop.to.index, loop.T_from_to, loop_information(noise)};
}

OdometryChain chain_of(const RobotGraph& graph, double slack) {
  std::vector<Pose> poses;
  std::vector<Matrix6> steps;
  for (std::size_t k = 0; k < graph.nodes.size(); ++k) {
    poses.push_back(graph.nodes[k].T_odom_base);
    if (k > 0) steps.push_back(slack * slack * graph.nodes[k].step_covariance);
  }
  return {std::move(poses), steps};
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/sync/fleet_graph.hpp"

namespace adit {

RobotGraph graph_of(const RobotMap& map) {
  RobotGraph graph{map.name, {}};
  graph.nodes.reserve(map.keyframes.size());
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    graph.nodes.push_back({map.keyframes[k].stamp, map.keyframes[k].T_odom_base, map.step_covariances[k]});
  }
  return graph;
}

PcmLoop pcm_loop_of(const LoopClosure& loop) {
  return {loop.from.index, loop.to.index, loop.T_from_to, loop.information};
}

OdometryChain chain_of(const RobotGraph& graph) {
  std::vector<Pose> poses;
  std::vector<Matrix6> steps;
  for (std::size_t k = 0; k < graph.nodes.size(); ++k) {
    poses.push_back(graph.nodes[k].T_odom_base);
    if (k > 0) steps.push_back(graph.nodes[k].step_covariance);
  }
  return {std::move(poses), steps};
}

}  // namespace adit

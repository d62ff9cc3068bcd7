// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/sync/fleet_graph.hpp"

#include <optional>

#include "adit/core/decompositions.hpp"

namespace adit {

RobotGraph graph_of(const RobotMap& map) {
  RobotGraph graph{map.name, {}};
  graph.nodes.reserve(map.keyframes.size());
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    graph.nodes.push_back({map.keyframes[k].stamp, map.keyframes[k].T_odom_base, map.step_covariances[k]});
  }
  return graph;
}

bool is_usable(const Matrix6& covariance_or_information) {
  if (!covariance_or_information.allFinite()) return false;
  const std::optional<Matrix6> inverse = inverse_of_positive_definite(covariance_or_information);
  // Tiny ones pass Cholesky's decomposition and have an infinite inverse.
  return inverse && Matrix6(*inverse + inverse->transpose()).allFinite();
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

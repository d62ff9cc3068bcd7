// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "adit/fleet/sync/merge_policy.hpp"
#include "adit/fleet/sync/protocol.hpp"
#include "adit/posegraph/pcm.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {

/// The odometry graph of one robot, as its owner and others know it.
struct RobotGraph {
  std::string name;              ///< As its owner calls itself.
  std::vector<GraphNode> nodes;  ///< Index = keyframe index.
};

/// In ascending order; twice the same robot stands for revisits of its own map.
using RobotPair = std::pair<RobotId, RobotId>;
/// The ends of a loop, from < to.
using KeyframePair = std::pair<KeyframeId, KeyframeId>;

/// All that one agent knows: its own graph, and the graphs, loops and merge checks that messages brought.
/// Ordered containers throughout, so that two agents that know the same compute the same, to the last bit.
struct FleetGraph {
  MergePolicy policy = MergePolicy::adaptive;  ///< That of the agent which knows this.
  std::map<RobotId, RobotGraph> robots;        ///< Its own and all that it heard of, even without keyframes.
  std::map<KeyframePair, LoopClosure> loops;   ///< Registered candidates, accepted or not; from < to.
  std::map<RobotPair, MergeCheck> checks;      ///< The latest of each pair; {a, a}: revisits of robot a.
  /// Of pairs that the agent which knows this has to search and has not: why, in one sentence.
  std::map<RobotPair, std::string> unsearched = {};

  /// Messages about a keyframe may come before the graph that it belongs to.
  [[nodiscard]] bool knows(KeyframeId id) const {
    const auto robot = robots.find(id.robot);
    return robot != robots.end() && id.index < robot->second.nodes.size();
  }
};

/// What others learn of a robot's own map: stamps, poses and odometry steps of its keyframes.
[[nodiscard]] RobotGraph graph_of(const RobotMap& map);

/// Whether the solver can use a covariance or an information, each of which it turns into the other: positive
/// definite, with a finite inverse.
[[nodiscard]] bool is_usable(const Matrix6& covariance_or_information);

/// The loop as odometry chains see it.
[[nodiscard]] PcmLoop pcm_loop_of(const LoopClosure& loop);

/// The odometry of a robot.
[[nodiscard]] OdometryChain chain_of(const RobotGraph& graph);

}  // namespace adit

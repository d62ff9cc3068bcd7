// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/fleet/sync/merge_policy.hpp"
#include "adit/fleet/sync/protocol.hpp"
#include "adit/posegraph/gnc.hpp"
#include "adit/posegraph/optimizer.hpp"
#include "adit/posegraph/pcm.hpp"
#include "adit/posegraph/pose_graph.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {

/// The graph of one robot as its owner and others know it.
struct RobotGraph {
  std::string name;
  std::vector<GraphNode> nodes;  ///< Index = keyframe index.
};

/// All that one agent knows: its own graph, the graphs and loops that messages brought. Ordered containers
/// throughout, so that two agents that know the same compute the same, to the last bit.
struct FleetGraph {
  MergePolicy policy = MergePolicy::adaptive;
  std::map<RobotId, RobotGraph> robots;
  std::map<std::pair<KeyframeId, KeyframeId>, LoopClosure> loops;
  std::map<std::pair<RobotId, RobotId>, MergeCheck> checks;
};

struct BackEndConfig {
  bool pcm_on = true;
  bool gnc_on = true;
  /// Under MergePolicy::adaptive only pairs with an accepted MergeCheck share a map,
  bool cycles_needed = true;      ///< as long as cycles of merges do not contradict it,
  bool joint_evidence = true;     ///< and pairs whose evidence suffices only when it is added up.
  int min_loops = 1;              ///< Loops in use between two robots before they count as merged.
  double loop_translation = 0.1;  ///< Fixed sigmas of a loop, as in Swarm-SLAM's back-end.
  double loop_rotation_deg = 0.6;
  PcmConfig pcm;
  GncConfig gnc;
};
Fields fields_of(BackEndConfig& config);

/// What became of one accepted loop.
struct LoopOutcome {
  LoopClosure loop;
  bool in_clique = false;  ///< Kept by PCM (always true with PCM off).
  double weight = 0.0;     ///< Final GNC weight; 0 where PCM dropped it.
  [[nodiscard]] bool in_use() const { return weight >= 0.5; }
};

/// How two robots that tried to find loops fared.
struct PairOutcome {
  RobotId a, b;
  std::size_t num_loops = 0;      ///< Accepted by the registration.
  std::size_t clique = 0;         ///< PCM's largest consistent set.
  std::size_t second_clique = 0;  ///< The largest one disjoint from it.
  bool clique_exact = true;
  bool merged = false;
  std::string joined_reason;   ///< One sentence where pairs together decided what its own test left open.
  std::string refused_reason;  ///< One sentence; "" when merged.
};

/// Robots that share one frame: that of `anchor`'s odometry, the smallest id of them.
struct Component {
  RobotId anchor;
  std::vector<RobotId> robots;
  SolveStatus status = SolveStatus::converged;
  std::string reason;  ///< Why the solver stopped, where it did not converge.
  int iterations = 0;
  double cost = 0.0;
};

struct FleetSolution {
  std::map<RobotId, std::vector<Pose>> T_world_keyframe;
  std::vector<LoopOutcome> loops;
  std::vector<PairOutcome> pairs;
  std::vector<Component> components;
  PoseGraph initial;    ///< All accepted loops, robots placed in a common frame by their loops.
  PoseGraph after_pcm;  ///< The same with only the loops that PCM kept.
  PoseGraph optimized;
};

/// What others learn of a robot's own map: its keyframes' stamps, poses and steps.
[[nodiscard]] RobotGraph graph_of(const RobotMap& map);
/// With sigmas of `slack` times those of its steps.
[[nodiscard]] OdometryChain chain_of(const RobotGraph& graph, double slack = 1.0);
/// The fixed information of a loop, from those sigmas.
[[nodiscard]] Matrix6 loop_information(const BackEndConfig& config);
/// The loop with that information.
[[nodiscard]] PcmLoop pcm_loop_of(const LoopClosure& loop, const BackEndConfig& config);

/// Where the odometry frame of robot b lies in that of robot a, by the average over loops from a to b (at
/// least one): chordal mean of the rotations, mean of the positions that they give to b's keyframes.
[[nodiscard]] Pose mean_frame(const FleetGraph& fleet, const std::vector<const LoopClosure*>& loops);

/// PCM per pair of robots, or the loops of the accepted checks but for those that merges with third robots
/// contradict; then GNC per connected component with odometry as known inliers.
/// A robot without loops is a component of its own, at its odometry. Loops whose keyframes are not (yet)
/// known take no part.
[[nodiscard]] FleetSolution solve(const FleetGraph& fleet, const BackEndConfig& config);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/refusal_kind.hpp"
#include "adit/fleet/joint/cycle.hpp"
#include "adit/fleet/sync/fleet_graph.hpp"
#include "adit/posegraph/gnc.hpp"
#include "adit/posegraph/optimizer.hpp"
#include "adit/posegraph/pcm.hpp"
#include "adit/posegraph/pose_graph.hpp"
#include "adit/posegraph/variance_components.hpp"

namespace adit {

/// Which loops take part in the joint solution, and how it is solved.
struct BackEndConfig {
  bool pcm_on = true;
  bool gnc_on = true;
  /// Under MergePolicy::adaptive pairs with an accepted MergeCheck share a map,
  bool cycles_needed = true;  ///< as long as cycles of merges do not contradict it,
  /// and each robot's odometry, and the loops of each pair, count by what they turn out to be worth.
  bool balance_on = true;
  int min_loops = 1;  ///< Loops in use between two robots before they count as merged.
  CycleConfig cycles;
  PcmConfig pcm;
  GncConfig gnc;
};
/// Keys of `cycles`, `pcm` and `gnc` begin with these names.
Fields fields_of(BackEndConfig& config);

/// What became of one accepted loop.
struct LoopOutcome {
  LoopClosure loop;          ///< As it was registered; both of its keyframes are known.
  bool is_selected = false;  ///< By PCM or by an accepted merge check (always true where neither is on).
  double weight = 0.0;       ///< Final GNC weight; 0 where it was not selected.
  /// Whether the solution relies on it. Loops of pairs that are not merged have weight 0.
  [[nodiscard]] bool in_use() const { return weight >= 0.5; }
};

/// How well the frame between two robots is known where they met: one standard deviation each, in the axes of
/// the second robot, so that "along" is where it drove.
struct MergeAccuracy {
  double along_m = 0.0;       ///< Along x, forward.
  double across_m = 0.0;      ///< Along y, to the left.
  double up_m = 0.0;          ///< Along z.
  double turn_deg = 0.0;      ///< About all axes together.
  std::size_t num_loops = 0;  ///< In use between the two.
  /// Of the loop in the middle, where it is measured.
  ///@{
  KeyframeId from, to;
  ///@}
  Matrix6 covariance = Matrix6::Zero();  ///< Of T_from_to, right perturbation, [translation; rotation].
};

/// What became of two robots.
struct PairOutcome {
  /// The smaller id, and the larger one.
  ///@{
  RobotId a, b;
  ///@}
  std::size_t num_loops = 0;     ///< Accepted by the registration.
  std::size_t num_selected = 0;  ///< Loops that take part: PCM's largest clique, or those of the merge check.
  std::size_t second_clique = 0;  ///< PCM's largest clique disjoint from it.
  bool clique_exact = true;       ///< PCM proved both to be the largest.
  bool merged = false;  ///< Enough of their own loops are in use; else third robots may still join them.
  std::optional<MergeAccuracy> accuracy = {};       ///< By measure_merges.
  RefusalKind refused_kind = RefusalKind::unknown;  ///< Where it is not merged.
  std::string refused_reason;                       ///< One sentence; "" when merged.
};

/// Robots that share one frame: that of `anchor`'s odometry, the smallest id of them.
struct Component {
  RobotId anchor;               ///< robots.front().
  std::vector<RobotId> robots;  ///< Ascending; one alone where no loop in use leads to another.
  /// Of the graph that was solved, which robots that were not merged in the end may have been part of.
  SolveStatus status = SolveStatus::converged;
  std::string reason;  ///< Why the solver stopped, where it did not converge.
  int iterations = 0;  ///< Linear systems solved for that graph, by all stages together.
  double cost = 0.0;   ///< chi2 of that graph as solved, edges by their weights and variances.
};

/// Whose measurements: the odometry of one robot (twice the same) or the loops between two.
struct MeasurementSource {
  EdgeKind kind = EdgeKind::odometry;  ///< Of all edges of this source.
  RobotPair robots;                    ///< In ascending order; of loops within one map twice the same, too.
  auto operator<=>(const MeasurementSource&) const = default;
};

/// Where all keyframes are that are known, and what became of the loops on the way.
struct FleetSolution {
  /// Of each robot, one per keyframe; the world is the odometry frame of its component's anchor.
  std::map<RobotId, std::vector<Pose>> T_world_keyframe;
  std::vector<LoopOutcome> loops;     ///< In the order of FleetGraph::loops.
  std::vector<PairOutcome> pairs;     ///< Any two robots once, in ascending order.
  std::vector<Component> components;  ///< Every robot is in one; by ascending anchor.
  PoseGraph initial;                  ///< All accepted loops, robots placed in a common frame by their loops.
  PoseGraph after_pcm;                ///< The same with only the loops that are selected.
  /// With the information that each source turned out to have, where `BackEndConfig::balance_on`.
  PoseGraph optimized;
  std::map<MeasurementSource, VarianceComponent> variances;  ///< Empty where nothing was balanced.
};

/// Selects loops (select_loops), then solves each connected component by GNC with odometry as known inliers,
/// and balances what is in use (optimize_balanced).
/// A robot without loops is a component of its own, at its odometry. Loops whose keyframes are not (yet)
/// known take no part.
[[nodiscard]] FleetSolution solve(const FleetGraph& fleet, const BackEndConfig& config);

}  // namespace adit

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
Fields fields_of(BackEndConfig& config);

/// What became of one accepted loop.
struct LoopOutcome {
  LoopClosure loop;
  bool is_selected = false;  ///< By PCM or by an accepted merge check (always true where neither is on).
  double weight = 0.0;       ///< Final GNC weight; 0 where it was not selected.
  [[nodiscard]] bool in_use() const { return weight >= 0.5; }
};

/// How well the frame between two robots is known where they met: one standard deviation each, in the axes of
/// the second robot, so that "along" is where it drove.
struct MergeAccuracy {
  double along_m = 0.0;
  double across_m = 0.0;
  double up_m = 0.0;
  double turn_deg = 0.0;                 ///< About all axes together.
  std::size_t num_loops = 0;             ///< In use between the two.
  KeyframeId from, to;                   ///< Of the loop in the middle, where it is measured.
  Matrix6 covariance = Matrix6::Zero();  ///< Of T_from_to, right perturbation, [translation; rotation].
};

/// What became of two robots.
struct PairOutcome {
  RobotId a, b;
  std::size_t num_loops = 0;     ///< Accepted by the registration.
  std::size_t num_selected = 0;  ///< Loops that take part: PCM's largest clique, or those of the merge check.
  std::size_t second_clique = 0;  ///< PCM's largest clique disjoint from it.
  bool clique_exact = true;       ///< PCM proved both to be the largest.
  bool merged = false;
  std::optional<MergeAccuracy> accuracy = {};       ///< By measure_merges.
  RefusalKind refused_kind = RefusalKind::unknown;  ///< Where it is not merged.
  std::string refused_reason;                       ///< One sentence; "" when merged.
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

/// Whose measurements: the odometry of one robot (twice the same) or the loops between two.
struct MeasurementSource {
  EdgeKind kind = EdgeKind::odometry;
  RobotPair robots;
  auto operator<=>(const MeasurementSource&) const = default;
};

struct FleetSolution {
  std::map<RobotId, std::vector<Pose>> T_world_keyframe;
  std::vector<LoopOutcome> loops;
  std::vector<PairOutcome> pairs;
  std::vector<Component> components;
  PoseGraph initial;    ///< All accepted loops, robots placed in a common frame by their loops.
  PoseGraph after_pcm;  ///< The same with only the loops that PCM kept.
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

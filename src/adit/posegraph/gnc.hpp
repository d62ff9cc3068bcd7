// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include "adit/core/config.hpp"
#include "adit/posegraph/optimizer.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// How false loops are found.
struct GncConfig {
  double inlier_probability =
      0.999;                       ///< Share of true loops whose chi2 (unhalved) is below chi2inv(this, dof).
  double mu_step = 1.4;            ///< Factor on the control parameter from one outer iteration to the next.
  int max_outer_iterations = 100;  ///< Updates of weights, at most.
  bool plain =
      false;  ///< One graduated search from least squares with all loops, as in the paper: to compare.
  OptimizerConfig optimizer;  ///< Of each solution.
};
/// The same, and optimizer.*.
inline Fields fields_of(GncConfig& c) {
  Fields fields = {
      {"inlier_probability", &c.inlier_probability, "", 0.5, 0.999999,
       "share of true loops that the bound keeps"},
      {"mu_step", &c.mu_step, "", 1.01, 10.0, "growth of the control parameter per outer iteration"},
      {"max_outer_iterations", &c.max_outer_iterations, "", 1, 10000, "weight updates, at most"},
      {"plain", &c.plain, "", 0, 0,
       "the paper's search alone, for comparison: no clusters, no fitted bound, no second pass"}};
  append(fields, "optimizer", fields_of(c.optimizer));
  return fields;
}

/// Pose-graph optimization that finds the false loops itself: graduated non-convexity with truncated least
/// squares. Odometry edges are known inliers and keep weight 1; every loop ends with weight 1, or 0 if
/// rejected. The bound is on unhalved chi2 (c^2 = chi2inv(p, dof): 22.46 at 6 dof, 16.27 at 3), which is
/// GTSAM's on halved errors. Each outer iteration starts from the poses of the one before.
///
/// It starts from loops that confirm one another (loop_clusters.hpp): least squares over the largest
/// clusters, then all loops that this explains, in rounds of choosing loops and solving anew until they stay
/// the same. Where loops fit better than their information says, the bound shrinks to four times what the
/// kept ones call for, but not below what chi2 over the redundancy of the solution calls for. That alone
/// settles most graphs, and never factorizes the dense matrix that random loops make. Unless it ends clearly
/// well (odometry unbent; few loops rejected, or only small clusters; nothing come loose; the cycles of the
/// solution no worse than short cycles over neighbouring loops say), graduated searches follow: from the
/// graph's own poses, once with each piece of a cluster weighing as much as one loop, and from the
/// least-squares solution with all loops. The most likely wins: one measure for all (loop_evidence.hpp), by
/// which the loops of one piece are rejected at the price of one mistake.
///
/// Then groups of loops are tried (loop_trials.hpp). A group that the rest contradicts is rejected. A group
/// that fits, but which the rest predicts so loosely that a false one would have fitted too, is refused where
/// clusters of its size were false elsewhere: weight 0, listed in `Solution::refused`, with a note.
///
/// `plain` skips both paragraphs above: graduated searches from the graph's own poses and from least squares
/// with all loops, each with a last solve over the loops below the bound; the lower truncated cost wins.
/// Source: Yang, Antonante, Tzoumas, Carlone, "Graduated Non-Convexity for Robust Spatial Perception" (RA-L
/// 2020), Proposition 4 (weights), Remark 5 (mu).
template <class P>
[[nodiscard]] Solution<P> optimize_gnc(const BasicPoseGraph<P>& graph, const GncConfig& config = {});

/// Upper quantile of the chi-square distribution: P(x <= result) = probability. Accurate to 1e-9 relative.
[[nodiscard]] double chi2_quantile(double probability, int dof);

}  // namespace adit

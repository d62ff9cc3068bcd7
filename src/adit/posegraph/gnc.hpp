// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "adit/core/config.hpp"
#include "adit/posegraph/optimizer.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

struct GncConfig {
  double inlier_probability =
      0.99;              ///< A true loop's chi2 (unhalved) is below chi2inv(this, dof) that often.
  double mu_step = 1.4;  ///< Factor on the control parameter from one outer iteration to the next.
  int max_outer_iterations = 100;
  OptimizerConfig optimizer;
};
inline Fields fields_of(GncConfig& c) {
  Fields fields = {
      {"inlier_probability", &c.inlier_probability, "", 0.5, 0.999999,
       "share of true loops that the bound keeps"},
      {"mu_step", &c.mu_step, "", 1.01, 10.0, "growth of the control parameter an outer iteration"},
      {"max_outer_iterations", &c.max_outer_iterations, "", 1, 10000, "weight updates, at most"}};
  append(fields, "optimizer", fields_of(c.optimizer));
  return fields;
}

/// Pose-graph optimization that finds the false loops itself: graduated non-convexity with truncated least
/// squares. Odometry edges are known inliers and keep weight 1; every loop ends with a weight in [0, 1], 0
/// for rejected ones. The bound is on unhalved chi2 (c^2 = chi2inv(p, dof): 16.81 at 6 dof, 11.34 at 3),
/// which is GTSAM's on halved errors. Each outer iteration starts from the poses of the one before.
/// `initial_weights` (one an edge, or empty: all 1) are the loops' weights of the first solve, e.g. from
/// pairwise consistency; they may recover from any value. Source: Yang, Antonante, Tzoumas, Carlone,
/// "Graduated Non-Convexity for Robust Spatial Perception" (RA-L 2020), Proposition 4 (weights), Remark 5
/// (mu).
template <class P>
[[nodiscard]] Solution<P> optimize_gnc(const BasicPoseGraph<P>& graph, const GncConfig& config = {},
                                       const std::vector<double>& initial_weights = {});

/// Upper quantile of the chi-square distribution: P(x <= result) = probability. Accurate to 1e-9 relative.
[[nodiscard]] double chi2_quantile(double probability, int dof);

}  // namespace adit

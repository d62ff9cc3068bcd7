// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/posegraph/optimizer.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// How well one source of measurements (a robot's odometry, the loops between two robots) fits the others.
struct VarianceComponent {
  /// Of its measurements, by that which their information states: 1 where they err as stated, more where they
  /// state too much. Drawn towards 1 where little is redundant.
  double variance = 1.0;
  double chi2 = 0.0;          ///< Of its residuals, by the information as stated.
  double redundancy = 0.0;    ///< How many of its numbers the rest of the graph checks.
  std::size_t num_edges = 0;  ///< Those of weight 0 not counted.
};

/// A solution, and how well its sources fit one another.
template <class P>
struct BalancedSolution {
  Solution<P> solution;                       ///< Iterations count over all rounds.
  std::vector<VarianceComponent> components;  ///< One per source.
};

/// Least squares from the graph's poses that weighs sources against one another by what their residuals show:
/// each source's information is divided by its variance, which is estimated anew until it stays. chi2 of the
/// solution is by the information so divided. `source_of_edge`: one per edge, 0 to num_sources - 1.
///
/// Residuals alone say too little of a variance: what few measurements check fits almost exactly, whatever it
/// is worth. chi2 is divided by the redundancy, n - tr(Omega J H^-1 J^T), whose trace is estimated by random
/// signs, the same ones every time. Both count as added to six numbers that fit as stated. No variance counts
/// as less than `least_variance`: residuals do not show the errors that all measurements of a source share.
/// Fails where `optimize` does. Source: Foerstner, "Ein Verfahren zur Schaetzung von Varianz- und
/// Kovarianzkomponenten" (AVN 1979); Hutchinson, "A stochastic estimator of the trace of the influence
/// matrix" (Communications in Statistics 1990).
template <class P>
[[nodiscard]] BalancedSolution<P> optimize_balanced(const BasicPoseGraph<P>& graph,
                                                    const std::vector<std::size_t>& source_of_edge,
                                                    std::size_t num_sources, const OptimizerConfig& config,
                                                    const std::vector<double>& edge_weights,
                                                    double least_variance = 0.0);

}  // namespace adit

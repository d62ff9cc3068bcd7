// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// How steps are taken.
enum class SolveMethod { levenberg_marquardt, gauss_newton };
/// Both methods.
inline constexpr std::array kSolveMethods{SolveMethod::levenberg_marquardt, SolveMethod::gauss_newton};
[[nodiscard]] std::string_view to_string(SolveMethod method);  ///< lm, gn

/// Where the search starts: at the better of the two that follow; at the poses given; at chordal relaxation.
enum class SolveStart { better, given, chordal };
/// All starts.
inline constexpr std::array kSolveStarts{SolveStart::better, SolveStart::given, SolveStart::chordal};
[[nodiscard]] std::string_view to_string(SolveStart start);  ///< auto, none, chordal

/// How a graph is solved.
struct OptimizerConfig {
  SolveMethod method = SolveMethod::levenberg_marquardt;  ///< Of the steps.
  SolveStart initialization = SolveStart::better;         ///< Where the search starts.
  int max_iterations = 100;                               ///< Linear systems, at most.
  double relative_tolerance = 1e-6;  ///< Stop when a step lowers the cost by less than this share of it.
  double initial_damping = 0.0;      ///< First lambda of LM, relative to the diagonal of the normal matrix.
};
/// The keys are the names of the fields.
inline Fields fields_of(OptimizerConfig& c) {
  return {
      enum_field("method", &c.method, kSolveMethods, "Levenberg-Marquardt or Gauss-Newton"),
      enum_field("initialization", &c.initialization, kSolveStarts,
                 "where to start: the given poses (none), chordal relaxation, or the better of both (auto)"),
      {"max_iterations", &c.max_iterations, "", 0, 100000, "linear systems solved, at most"},
      {"relative_tolerance", &c.relative_tolerance, "", 0.0, 1.0,
       "stop at this relative decrease of the cost"},
      {"initial_damping", &c.initial_damping, "", 0.0, 1e6, "first lambda of LM, relative to the diagonal"}};
}

/// Why the search ended.
enum class SolveStatus {
  converged,               ///< At a minimum.
  max_iterations,          ///< The poses are the best found so far.
  indefinite_information,  ///< An edge's information matrix has a negative eigenvalue or is not symmetric.
  singular,                ///< The edges leave some node free to move. The poses are those given.
  non_finite,              ///< The cost at the start is not a finite number.
};
/// The name of the status.
[[nodiscard]] std::string_view to_string(SolveStatus status);

/// Poses, and how well they fit.
template <class P>
struct Solution {
  std::vector<P> poses;       ///< T_world_node, one per node, in the order of the graph.
  double cost_initial = 0.0;  ///< chi2 = sum of r^T Omega r, unhalved, at the graph's own poses.
  double cost_final = 0.0;    ///< The same at `poses`, each edge multiplied by its weight.
  int iterations = 0;         ///< Linear systems solved.
  SolveStatus status = SolveStatus::converged;  ///< Why it ended.
  std::string reason;                           ///< Why it stopped, in one sentence.
  std::vector<std::string> notes;    ///< Remarks for the reader, e.g. that the graph has several components.
  std::vector<double> edge_weights;  ///< In [0, 1], one per edge; all 1 without `optimize_gnc`.
  std::vector<std::size_t> refused;  ///< Loops that fit, left out by `optimize_gnc` as nothing confirms them.

  /// Whether the poses are an answer.
  [[nodiscard]] bool ok() const {
    return status == SolveStatus::converged || status == SolveStatus::max_iterations;
  }
};

/// Minimises chi2 over all poses by Gauss-Newton or Levenberg-Marquardt with sparse Cholesky factorization.
/// The anchor of each connected component keeps its pose. `edge_weights` multiplies the information of each
/// edge (empty: all 1); edges of weight 0 are left out and connect nothing. Levenberg-Marquardt accepts steps
/// and sets its damping by the gain ratio, and takes a small decrease for the minimum only where nothing is
/// damped. The same bytes with any number of threads. Throws ContractViolation when an edge names a node that
/// does not exist. Source: Madsen, Nielsen, Tingleff, "Methods for non-linear least squares problems" (2004),
/// section 3.2.
template <class P>
[[nodiscard]] Solution<P> optimize(const BasicPoseGraph<P>& graph, const OptimizerConfig& config = {},
                                   const std::vector<double>& edge_weights = {});

/// chi2 of each edge at `poses`, unweighted.
template <class P>
[[nodiscard]] std::vector<double> edge_costs(const BasicPoseGraph<P>& graph, const std::vector<P>& poses);

/// Indices of edges whose information matrix is not symmetric positive semidefinite, ascending. A matrix may
/// be singular (an unconstrained direction), but no eigenvalue may be below -1e-9 times the largest. Edges
/// before `first` are skipped.
template <class P>
[[nodiscard]] std::vector<std::size_t> indefinite_edges(const BasicPoseGraph<P>& graph,
                                                        std::size_t first = 0);

}  // namespace adit

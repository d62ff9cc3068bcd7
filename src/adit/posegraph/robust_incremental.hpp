// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/posegraph/incremental.hpp"

namespace adit {

/// When a loop is believed, and how far a step solves.
struct RobustIncrementalConfig {
  double inlier_probability = 0.999;  ///< Share of true loops whose chi2 is within the bound.
  double true_share = 0.9995;         ///< Of loops with just enough evidence, so many are true.
  int max_iterations = 2;             ///< Linear systems per step; what remains is done in the next one.
  double relative_tolerance = 1e-4;   ///< Of the cost: a solution that would fall by less is one.
};
/// The keys are the names of the fields.
inline Fields fields_of(RobustIncrementalConfig& c) {
  return {{"inlier_probability", &c.inlier_probability, "", 0.5, 0.999999,
           "share of true loops that the bound keeps"},
          {"true_share", &c.true_share, "", 0.5, 0.999999999,
           "share of true loops among those with just enough evidence"},
          {"max_iterations", &c.max_iterations, "", 1, 1000, "linear systems per step, at most"},
          {"relative_tolerance", &c.relative_tolerance, "", 0.0, 1.0,
           "stop at this relative decrease of the cost"}};
}

/// Least squares over a pose graph that grows, and that finds its false loops as they come. Odometry is
/// trusted.
///
/// Each new loop is compared with what the graph predicts of it without it. Its chi2 by the covariance of
/// both must be within the bound, and the logarithm of its odds high enough: if true, its residual has that
/// covariance; if false, it may join any two poses of the map, and is as frequent as loops were false so far.
/// A loop within the bound without the evidence waits. Two loops that wait, or a new one and one that waits,
/// are compared together: they may confirm one another. In each step the loops in use whose own residual has
/// left the bound are taken out, the worst first, and loops left out are examined again, those at nodes that
/// moved before others, within a budget per step.
///
/// The covariances are those stated, times a variance: chi2 of what is in use over its redundancy, at most 1,
/// and larger while the redundancy is small (the a-posteriori variance of unit weight, as in
/// loop_evidence.hpp). Source: for the test, Neira and Tardos, "Data association in stochastic mapping using
/// the joint compatibility test" (T-RA 2001); for what it is measured by, McGann, Rogers, Kaess, "Robust
/// Incremental Smoothing and Mapping (riSAM)" (ICRA 2023).
template <class P>
class RobustIncremental {
 public:
  using Edge = typename BasicPoseGraph<P>::Edge;  ///< As of the graph.
  /// Without nodes.
  explicit RobustIncremental(const RobustIncrementalConfig& config = {});
  /// What was moved from may only be destroyed or assigned to.
  ///@{
  RobustIncremental(RobustIncremental&&) noexcept;
  RobustIncremental& operator=(RobustIncremental&&) noexcept;
  ///@}
  ~RobustIncremental();

  /// See `IncrementalOptimizer`. A loop is judged in the next update.
  ///@{
  std::size_t add_node(std::uint64_t key, const P& pose);
  std::size_t add_edge(const Edge& edge);
  ///@}

  /// What an update did.
  struct Step {
    SolveStatus status = SolveStatus::converged;  ///< Of its last solution.
    std::string reason;                           ///< Why that stopped, in one sentence.
    std::vector<std::size_t> accepted;            ///< Loops that are in use since this step.
    std::vector<std::size_t> dropped;             ///< Loops that were in use before it.
    std::size_t num_waiting = 0;                  ///< Loops within the bound that lack evidence.
    double variance = 1.0;                        ///< Of the measurements, by what their information states.
    int iterations = 0;                           ///< Linear systems solved, over all its solutions.
  };
  /// Solves with all that was added, judges the new loops, and examines others again. A solution that fails,
  /// as `IncrementalOptimizer::update` may, ends the step.
  Step update();

  /// Whether the edge counts at present; odometry does from the start.
  [[nodiscard]] bool is_in_use(std::size_t edge) const;
  /// T_world_node, one per node; of a node that was added since the last update as given.
  [[nodiscard]] const std::vector<P>& poses() const;
  /// Everything added so far, in use or not; node poses as given.
  [[nodiscard]] const BasicPoseGraph<P>& graph() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "adit/posegraph/optimizer.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// Least squares over a pose graph that grows keyframe by keyframe: the same minimum as `optimize` on the
/// graph so far, at a cost that follows the change, not the size. Every `update` goes on to convergence.
///
/// The factor belongs to the linearization of each edge when it came. In the local frames of factors.hpp that
/// depends on relative poses only, which a loop hardly changes even where it moves the whole trajectory; the
/// gradient is exact at every step. Where steps converge slowly all edges are linearized anew.
///
/// Gauge: the first node keeps its pose. When `update` is called every node must hang together with the
/// first.
template <class P>
class IncrementalOptimizer {
 public:
  using Edge = typename BasicPoseGraph<P>::Edge;
  explicit IncrementalOptimizer(const OptimizerConfig& config = {});
  IncrementalOptimizer(IncrementalOptimizer&&) noexcept;
  IncrementalOptimizer& operator=(IncrementalOptimizer&&) noexcept;
  ~IncrementalOptimizer();

  /// Returns the index of the node. `pose`: where the solver starts; for a new keyframe the last pose times
  /// the odometry.
  std::size_t add_node(std::uint64_t key, const P& pose);
  /// Throws ContractViolation when it names a node that is not there or joins a node to itself.
  void add_edge(const Edge& edge);

  struct Update {
    SolveStatus status = SolveStatus::converged;
    std::string reason;              ///< Why it stopped, in one sentence.
    int iterations = 0;              ///< Linear systems solved.
    double cost = 0.0;               ///< chi2 at the poses.
    bool all_renewed = false;        ///< Every edge was linearized anew.
    std::size_t num_renewed = 0;     ///< Supernodes eliminated, ...
    std::size_t num_supernodes = 0;  ///< ... of so many.
  };
  /// Indefinite information, a node left free or a cost that is not finite are reported in `status`; the
  /// poses then stay as they were.
  Update update();

  [[nodiscard]] const std::vector<P>& poses() const;
  [[nodiscard]] const BasicPoseGraph<P>& graph() const;  ///< All that was added; node poses as given.

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adit

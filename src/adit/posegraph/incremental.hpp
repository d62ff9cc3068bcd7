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

/// Least squares over a pose graph that grows keyframe by keyframe, for robots that solve while they drive.
/// Reaches the minimum of `optimize` on the graph so far; every `update` iterates to convergence. No command
/// of `adit` uses it yet: it is kept for agents that work online.
///
/// Cost of an update: the factorization is renewed only where the graph changed, which for a new keyframe is
/// a few supernodes. Each iteration also evaluates the gradient of all edges and steps all nodes, so it is
/// linear in the size of the graph, as is the copy of the poses that each update keeps to fall back on.
///
/// Each edge contributes to the factor as linearized when it was added. In the local frames of factors.hpp
/// that depends on relative poses only, which a loop hardly changes even where it moves the whole trajectory.
/// The gradient is exact at every step. Where steps converge slowly, all edges are linearized anew.
///
/// Gauge: the first node keeps its pose. When `update` is called, edges must connect every node to the first.
/// Source: Kaess, Johannsson, Roberts, Ila, Leonard, Dellaert, "iSAM2" (IJRR 2012), for the factorization;
/// unlike there, the gradient is never stale.
template <class P>
class IncrementalOptimizer {
 public:
  using Edge = typename BasicPoseGraph<P>::Edge;
  explicit IncrementalOptimizer(const OptimizerConfig& config = {});
  IncrementalOptimizer(IncrementalOptimizer&&) noexcept;
  IncrementalOptimizer& operator=(IncrementalOptimizer&&) noexcept;
  ~IncrementalOptimizer();

  /// Returns the index of the node. `pose`: T_world_node where the solver starts; for a new keyframe the last
  /// pose times the odometry.
  std::size_t add_node(std::uint64_t key, const P& pose);
  /// Throws ContractViolation when the edge names a node that does not exist or joins a node to itself.
  void add_edge(const Edge& edge);

  struct Update {
    SolveStatus status = SolveStatus::converged;
    std::string reason;              ///< Why it stopped, in one sentence.
    int iterations = 0;              ///< Linear systems solved.
    double cost = 0.0;               ///< chi2 at the poses.
    bool all_renewed = false;        ///< Every edge was linearized anew.
    std::size_t num_renewed = 0;     ///< Supernodes eliminated at the start of this update.
    std::size_t num_supernodes = 0;  ///< Supernodes of the whole factor.
  };
  /// Reports indefinite information, a node free to move or a cost that is not finite in `status`; the poses
  /// then stay as they were.
  Update update();

  [[nodiscard]] const std::vector<P>& poses() const;
  [[nodiscard]] const BasicPoseGraph<P>& graph() const;  ///< Everything added so far; node poses as given.

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adit

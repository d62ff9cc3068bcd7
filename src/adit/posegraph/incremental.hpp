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

/// Whether an edge counts in the cost.
enum class EdgeUse { in_use, out_of_use };

/// Least squares over a pose graph that grows keyframe by keyframe, for robots that solve while they drive.
/// Reaches the minimum of `optimize` on the graph so far; every `update` iterates to convergence. Edges can
/// be taken out of use and put back.
///
/// Cost of an update: that of what changes. The factor is renewed on the paths from changed nodes to the root
/// of the elimination tree, the right side is eliminated along the paths of nodes whose gradient is not
/// negligible, and steps are solved for downwards from the root as long as they exceed ten micrometres or
/// microradians. Only edges of nodes that moved are evaluated again. An update after one that converged,
/// where no edge was added that pulls at the poses, solves nothing. A sum over the costs of all edges is what
/// remains linear in the size of the graph.
///
/// Each edge contributes to the factor as linearized when it was added. In the local frames of factors.hpp
/// that depends on its relative pose only, which a loop hardly changes even where it moves the whole
/// trajectory. An edge is linearized anew where its relative pose has changed by more than a tenth, where the
/// errors that a step makes by such changes would reach half of its gain, and, if it has changed at all,
/// where steps converge slowly. The gradient is exact at every step.
///
/// Gauge: the first node keeps its pose. When `update` is called, edges in use must connect every node to it.
/// Source: Kaess, Johannsson, Roberts, Ila, Leonard, Dellaert, "iSAM2" (IJRR 2012); unlike there, an edge is
/// stale by its own relative pose, not by how far its nodes moved, and the gradient is never stale.
template <class P>
class IncrementalOptimizer {
 public:
  using Edge = typename BasicPoseGraph<P>::Edge;  ///< As of the graph.
  /// Without nodes. The settings are those of each update.
  explicit IncrementalOptimizer(const OptimizerConfig& config = {});
  /// What was moved from may only be destroyed or assigned to.
  ///@{
  IncrementalOptimizer(IncrementalOptimizer&&) noexcept;
  IncrementalOptimizer& operator=(IncrementalOptimizer&&) noexcept;
  ///@}
  ~IncrementalOptimizer();

  /// Returns the index of the node. `pose`: T_world_node where the solver starts; for a new keyframe the last
  /// pose times the odometry.
  std::size_t add_node(std::uint64_t key, const P& pose);
  /// Returns the index of the edge. Throws ContractViolation when the edge names a node that does not exist
  /// or joins a node to itself.
  std::size_t add_edge(const Edge& edge, EdgeUse use = EdgeUse::in_use);
  /// From the next update on.
  void set_use(std::size_t edge, EdgeUse use);
  /// As it was set last, even before the next update.
  [[nodiscard]] bool is_used(std::size_t edge) const;
  /// Of an edge in use, at the poses, after a successful update.
  [[nodiscard]] double chi2(std::size_t edge) const;

  /// What an update did.
  struct Update {
    SolveStatus status = SolveStatus::converged;  ///< Why it ended, as in `Solution`.
    std::string reason;                           ///< Why it stopped, in one sentence.
    int iterations = 0;                           ///< Linear systems solved.
    double cost = 0.0;                            ///< chi2 of the edges in use at the poses.
    std::size_t num_renewed = 0;                  ///< Supernodes eliminated in this update.
    std::size_t num_supernodes = 0;               ///< Supernodes of the whole factor.
    std::size_t num_linearized = 0;               ///< Edges linearized anew, those just added not counted.
    std::size_t num_evaluated = 0;                ///< Evaluations of edges.
    std::vector<std::size_t> moved;  ///< Nodes with another pose than before the update, ascending.
  };
  /// Reports a node free to move or a cost that is not finite in `status`; the poses then stay as they were.
  /// An edge with indefinite information is reported likewise, and is out of use afterwards.
  Update update();
  /// The same with at most so many linear systems. With none, the factor is renewed and the poses stay.
  Update update(int max_iterations);

  /// What the edges in use predict of the residuals of other edges, to first order at the poses.
  struct Prediction {
    Eigen::VectorXd residual;    ///< One after the other, kDof numbers each.
    Eigen::MatrixXd covariance;  ///< Of these residuals, by the poses alone, not by the measurements.
  };
  /// Of edges that are out of use, after a successful update.
  [[nodiscard]] Prediction predict(const std::vector<std::size_t>& edges);

  /// T_world_node, one per node; of a node that was added since the last update as given.
  [[nodiscard]] const std::vector<P>& poses() const;
  [[nodiscard]] const BasicPoseGraph<P>& graph() const;  ///< Everything added so far; node poses as given.

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adit

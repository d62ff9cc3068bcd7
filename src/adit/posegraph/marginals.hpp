// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// Marginal covariances of node poses (right perturbation, [translation; rotation]; metres and radians), with
/// the anchor of each component held fixed, at the linearization point graph.nodes[i].pose: put the solution
/// in first. Factorizes once; each query then costs two sparse triangular solves per column. Source: Kaess,
/// Dellaert, "Covariance recovery from a square root information matrix for data association" (RAS 2009),
/// section 3.
template <class P>
class Marginals {
 public:
  using Covariance = Eigen::Matrix<double, P::kDof, P::kDof>;  ///< Of one pose.
  /// Of two poses.
  using JointCovariance = Eigen::Matrix<double, 2 * P::kDof, 2 * P::kDof>;

  /// Fails when the graph is singular or an information matrix is indefinite. `edge_weights` as in
  /// `optimize`.
  static Result<Marginals> compute(const BasicPoseGraph<P>& graph,
                                   const std::vector<double>& edge_weights = {});

  /// Of one node; zero for an anchor.
  [[nodiscard]] Covariance covariance(std::size_t node) const;
  /// Of two nodes together: [a; b].
  [[nodiscard]] JointCovariance joint(std::size_t a, std::size_t b) const;
  /// Of the nodes `rows` with the nodes `columns`: kDof rows and columns for each, zero for an anchor.
  [[nodiscard]] Eigen::MatrixXd cross(const std::vector<std::size_t>& rows,
                                      const std::vector<std::size_t>& columns) const;
  /// Of T_a_b, right perturbation. Only meaningful for two nodes of one component.
  [[nodiscard]] Covariance relative(std::size_t a, std::size_t b) const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/marginals.hpp"

#include <algorithm>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/posegraph/factors.hpp"
#include "adit/posegraph/normal_equations.hpp"
#include "adit/posegraph/optimizer.hpp"

namespace adit {

template <class P>
struct Marginals<P>::Impl {
  GraphStructure structure;
  std::vector<P> poses;
  BlockCholesky cholesky;

  static Eigen::Index at(std::size_t i) { return static_cast<Eigen::Index>(i) * P::kDof; }

  // Rows of `rows` in the columns of H^-1 that belong to `nodes`; zero where a node is an anchor.
  [[nodiscard]] Eigen::MatrixXd inverse_rows(const std::vector<std::size_t>& rows,
                                             const std::vector<std::size_t>& nodes) const {
    constexpr int D = P::kDof;
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(at(structure.node_of_variable.size()), at(nodes.size()));
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      const std::size_t v = structure.variable_of_node[nodes[k]];
      if (v != GraphStructure::kFixed) unit.block(at(v), at(k), D, D).setIdentity();
    }
    const Eigen::MatrixXd columns = cholesky.solve(unit);
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(at(rows.size()), at(nodes.size()));
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const std::size_t v = structure.variable_of_node[rows[k]];
      if (v != GraphStructure::kFixed) out.middleRows(at(k), D) = columns.middleRows(at(v), D);
    }
    return out;
  }
  [[nodiscard]] Eigen::MatrixXd inverse_block(const std::vector<std::size_t>& nodes) const {
    const Eigen::MatrixXd block = inverse_rows(nodes, nodes);
    return 0.5 * (block + block.transpose());
  }
};

template <class P>
Result<Marginals<P>> Marginals<P>::compute(const BasicPoseGraph<P>& graph,
                                           const std::vector<double>& edge_weights) {
  graph.check();
  ADIT_CHECK(edge_weights.empty() || edge_weights.size() == graph.edges.size(),
             "one weight per edge, or none");
  if (const auto bad = indefinite_edges(graph); !bad.empty()) {
    return fail(format("{} of {} information matrices are indefinite", bad.size(), graph.edges.size()));
  }
  GraphStructure structure = structure_of(graph, connected_components(graph, edge_weights), edge_weights);
  const std::vector<P> poses = poses_of(graph);
  BlockCholesky cholesky(analyze(structure.pattern), P::kDof);
  if (const auto free = cholesky.factorize(linearize(graph, structure, poses, edge_weights).values)) {
    return fail(format("no covariance: the edges leave node {} free to move",
                       graph.nodes[structure.node_of_variable[*free]].key));
  }
  Marginals out;
  out.impl_ = std::make_shared<const Impl>(Impl{std::move(structure), poses, std::move(cholesky)});
  return out;
}

template <class P>
typename Marginals<P>::Covariance Marginals<P>::covariance(std::size_t node) const {
  ADIT_CHECK(node < impl_->poses.size(), "a node of the graph");
  return impl_->inverse_block({node});
}

template <class P>
typename Marginals<P>::JointCovariance Marginals<P>::joint(std::size_t a, std::size_t b) const {
  ADIT_CHECK(a < impl_->poses.size() && b < impl_->poses.size(), "two nodes of the graph");
  return impl_->inverse_block({a, b});
}

template <class P>
Eigen::MatrixXd Marginals<P>::cross(const std::vector<std::size_t>& rows,
                                    const std::vector<std::size_t>& columns) const {
  const auto is_node = [&](std::size_t node) { return node < impl_->poses.size(); };
  ADIT_CHECK(std::ranges::all_of(rows, is_node) && std::ranges::all_of(columns, is_node),
             "nodes of the graph");
  return impl_->inverse_rows(rows, columns);
}

template <class P>
typename Marginals<P>::Covariance Marginals<P>::relative(std::size_t a, std::size_t b) const {
  ADIT_CHECK(a < impl_->poses.size() && b < impl_->poses.size(), "two nodes of the graph");
  constexpr int D = P::kDof;
  // A perturbation of T_world_a moves to the far end of T_a_b by the adjoint of T_b_a.
  Eigen::Matrix<double, D, 2 * D> J;
  J << -(impl_->poses[b].inverse() * impl_->poses[a]).adjoint(), Covariance::Identity();
  return J * joint(a, b) * J.transpose();
}

template class Marginals<Pose>;
template class Marginals<Pose2>;

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "adit/posegraph/block_cholesky.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// Which nodes of a graph are unknowns, which edges contribute, and where the terms of each edge go in the
/// normal equations. Edges of weight 0 and edges between two anchors are left out.
struct GraphStructure {
  static constexpr std::size_t kFixed = static_cast<std::size_t>(-1);  ///< No unknown.
  /// One term of one block of the normal matrix.
  struct Term {
    std::size_t active_edge;  ///< Index into `active_edges`.
    /// A block of `EdgeTerms`; to_from is the transpose of from_to.
    enum class Part { from_from, to_to, from_to, to_from } part;  ///< The one that is added.
  };
  std::vector<std::size_t> variable_of_node;  ///< kFixed for anchors.
  std::vector<std::size_t> node_of_variable;  ///< Ascending.
  std::vector<std::size_t> active_edges;      ///< Indices of edges, ascending.
  BlockPattern pattern;                       ///< Of the normal matrix, which has a row for each variable.
  std::vector<std::size_t> term_start;        ///< First term of each block, then the number of terms.
  std::vector<Term> terms;                    ///< By block, in the order of the edges.
};
/// Anchors are those of `components`, which are of this graph with these weights (empty: all 1).
template <class P>
[[nodiscard]] GraphStructure structure_of(const BasicPoseGraph<P>& graph, const Components& components,
                                          const std::vector<double>& edge_weights);

/// H dx = -g: half the second and first derivatives of chi2, in the perturbation of factors.hpp.
struct NormalEquations {
  std::vector<double> values;  ///< Blocks of H in the order of the pattern.
  Eigen::VectorXd gradient;    ///< g = sum of w J^T Omega r.
};
/// H x.
template <int D>
[[nodiscard]] Eigen::VectorXd times(const BlockPattern& pattern, const std::vector<double>& values,
                                    const Eigen::VectorXd& x);
/// The contribution of one edge to the normal matrix, in blocks of size D. The caller fills it in,
/// `sum_terms` adds it up.
template <int D>
struct EdgeTerms {
  EdgeTerms() {
  }  // NOLINT(modernize-use-equals-default): a defaulted one would fill arrays of them with zeros
  /// Rows of the first node, columns of the second.
  ///@{
  Eigen::Matrix<double, D, D> from_from, to_to, from_to;
  ///@}
};
/// Blocks of the normal matrix in the order of the pattern, each column-major. `edges`: one per active edge.
///@{
template <int D>
void sum_terms(const GraphStructure& structure, const std::vector<EdgeTerms<D>>& edges,
               std::vector<double>& values);
template <int D>
[[nodiscard]] std::vector<double> sum_terms(const GraphStructure& structure,
                                            const std::vector<EdgeTerms<D>>& edges) {
  std::vector<double> values;
  sum_terms<D>(structure, edges, values);
  return values;
}
///@}

/// Linearizes one graph again and again in the same memory: to get it from the system anew takes as long as
/// the work. Graph, structure and weights must outlive it.
template <class P>
class Linearizer {
 public:
  /// `edge_weights`: one per edge of the graph (empty: all 1).
  Linearizer(const BasicPoseGraph<P>& graph, const GraphStructure& structure,
             const std::vector<double>& edge_weights);
  /// Valid until the next call.
  [[nodiscard]] const NormalEquations& at(const std::vector<P>& poses);

 private:
  struct EdgeGradient {
    typename P::Tangent from, to;
  };
  void linearize_edge(std::size_t active_edge, const std::vector<P>& poses);

  const BasicPoseGraph<P>& graph_;
  const GraphStructure& structure_;
  const std::vector<double>& edge_weights_;
  std::vector<EdgeTerms<P::kDof>> terms_;
  std::vector<EdgeGradient> gradients_;
  NormalEquations equations_;
};
/// The normal equations at these poses, T_world_node, for one time only.
template <class P>
[[nodiscard]] NormalEquations linearize(const BasicPoseGraph<P>& graph, const GraphStructure& structure,
                                        const std::vector<P>& poses, const std::vector<double>& edge_weights);

}  // namespace adit

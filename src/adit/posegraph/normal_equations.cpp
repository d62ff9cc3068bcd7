// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/normal_equations.hpp"

#include <numeric>

#include "adit/core/parallel.hpp"
#include "adit/posegraph/factors.hpp"

namespace adit {
namespace {
constexpr std::size_t kGrain = 256;  // edges or blocks that one thread takes at a time
}

template <class P>
GraphStructure structure_of(const BasicPoseGraph<P>& graph, const Components& components,
                            const std::vector<double>& edge_weights) {
  using Part = GraphStructure::Term::Part;
  GraphStructure s;
  s.variable_of_node.assign(graph.nodes.size(), 0);
  for (const std::size_t anchor : components.anchors) s.variable_of_node[anchor] = GraphStructure::kFixed;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    if (s.variable_of_node[i] == GraphStructure::kFixed) continue;
    s.variable_of_node[i] = s.node_of_variable.size();
    s.node_of_variable.push_back(i);
  }
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const std::size_t from = s.variable_of_node[graph.edges[e].from];
    const std::size_t to = s.variable_of_node[graph.edges[e].to];
    if (!edge_weights.empty() && edge_weights[e] <= 0.0) continue;
    if (from == GraphStructure::kFixed && to == GraphStructure::kFixed) continue;
    s.active_edges.push_back(e);
    if (from != GraphStructure::kFixed && to != GraphStructure::kFixed) pairs.emplace_back(from, to);
  }
  s.pattern = BlockPattern::of_pairs(s.node_of_variable.size(), std::move(pairs));

  const auto for_terms = [&](const auto& visit) {
    for (std::size_t a = 0; a < s.active_edges.size(); ++a) {
      const auto& edge = graph.edges[s.active_edges[a]];
      const std::size_t from = s.variable_of_node[edge.from];
      const std::size_t to = s.variable_of_node[edge.to];
      if (from != GraphStructure::kFixed) visit(s.pattern.column_start[from], a, Part::from_from);
      if (to != GraphStructure::kFixed) visit(s.pattern.column_start[to], a, Part::to_to);
      if (from == GraphStructure::kFixed || to == GraphStructure::kFixed) continue;
      visit(s.pattern.block(std::max(from, to), std::min(from, to)), a,
            from > to ? Part::from_to : Part::to_from);
    }
  };
  s.term_start.assign(s.pattern.num_blocks() + 1, 0);
  for_terms([&](std::size_t block, std::size_t, Part) { ++s.term_start[block + 1]; });
  std::partial_sum(s.term_start.begin(), s.term_start.end(), s.term_start.begin());
  s.terms.resize(s.term_start.back());
  std::vector<std::size_t> next(s.term_start.begin(), s.term_start.end() - 1);
  for_terms([&](std::size_t block, std::size_t a, Part part) { s.terms[next[block]++] = {a, part}; });
  return s;
}

template <int D>
void sum_terms(const GraphStructure& structure, const std::vector<EdgeTerms<D>>& edges,
               std::vector<double>& values) {
  using Block = Eigen::Matrix<double, D, D>;
  using Part = GraphStructure::Term::Part;
  values.resize(structure.pattern.num_blocks() * D * D);
  parallel_for_each(
      structure.pattern.num_blocks(),
      [&](std::size_t b) {
        Block sum = Block::Zero();
        for (std::size_t t = structure.term_start[b]; t < structure.term_start[b + 1]; ++t) {
          const EdgeTerms<D>& edge = edges[structure.terms[t].active_edge];
          switch (structure.terms[t].part) {
            case Part::from_from:
              sum += edge.from_from;
              break;
            case Part::to_to:
              sum += edge.to_to;
              break;
            case Part::from_to:
              sum += edge.from_to;
              break;
            case Part::to_from:
              sum += edge.from_to.transpose();
              break;
          }
        }
        Eigen::Map<Block>(values.data() + b * D * D) = sum;
      },
      kGrain);
}

template <int D>
Eigen::VectorXd times(const BlockPattern& pattern, const std::vector<double>& values,
                      const Eigen::VectorXd& x) {
  using Vector = Eigen::Matrix<double, D, 1>;
  using Block = Eigen::Map<const Eigen::Matrix<double, D, D>>;
  Eigen::VectorXd out = Eigen::VectorXd::Zero(x.size());
  const auto at = [](std::size_t i) { return static_cast<Eigen::Index>(i * D); };
  for (std::size_t j = 0; j < pattern.size(); ++j) {
    const std::size_t diagonal = pattern.column_start[j];
    const Vector own = x.segment<D>(at(j));
    Vector sum = Block(values.data() + diagonal * D * D) * own;
    for (std::size_t p = diagonal + 1; p < pattern.column_start[j + 1]; ++p) {
      const Block block(values.data() + p * D * D);
      out.segment<D>(at(pattern.row[p])) += block * own;
      sum += block.transpose() * x.segment<D>(at(pattern.row[p]));
    }
    out.segment<D>(at(j)) += sum;
  }
  return out;
}

template <class P>
Linearizer<P>::Linearizer(const BasicPoseGraph<P>& graph, const GraphStructure& structure,
                          const std::vector<double>& edge_weights)
    : graph_(graph),
      structure_(structure),
      edge_weights_(edge_weights),
      terms_(structure.active_edges.size()),
      gradients_(structure.active_edges.size()) {
  equations_.gradient.resize(static_cast<Eigen::Index>(structure.node_of_variable.size() * P::kDof));
}

template <class P>
void Linearizer<P>::linearize_edge(std::size_t a, const std::vector<P>& poses) {
  const std::size_t e = structure_.active_edges[a];
  const auto& edge = graph_.edges[e];
  const BetweenFactor<P> f = adit::linearize(edge.T_from_to, poses[edge.from], poses[edge.to]);
  const double weight = edge_weights_.empty() ? 1.0 : edge_weights_[e];
  const typename P::Jacobian information = weight * edge.information;
  const typename P::Jacobian from_information = f.d_from.transpose() * information;
  const typename P::Jacobian to_information = f.d_to.transpose() * information;
  terms_[a].from_from.noalias() = from_information * f.d_from;
  terms_[a].from_to.noalias() = from_information * f.d_to;
  terms_[a].to_to.noalias() = to_information * f.d_to;
  gradients_[a].from.noalias() = from_information * f.residual;
  gradients_[a].to.noalias() = to_information * f.residual;
}

template <class P>
const NormalEquations& Linearizer<P>::at(const std::vector<P>& poses) {
  constexpr int D = P::kDof;
  parallel_for_each(
      terms_.size(), [&](std::size_t a) { linearize_edge(a, poses); }, kGrain);
  sum_terms<D>(structure_, terms_, equations_.values);
  parallel_for_each(
      structure_.node_of_variable.size(),
      [&](std::size_t v) {
        const std::size_t diagonal = structure_.pattern.column_start[v];
        typename P::Tangent sum = P::Tangent::Zero();
        for (std::size_t t = structure_.term_start[diagonal]; t < structure_.term_start[diagonal + 1]; ++t) {
          const GraphStructure::Term& term = structure_.terms[t];
          const bool from = term.part == GraphStructure::Term::Part::from_from;
          sum += from ? gradients_[term.active_edge].from : gradients_[term.active_edge].to;
        }
        equations_.gradient.template segment<D>(static_cast<Eigen::Index>(v * D)) = sum;
      },
      kGrain);
  return equations_;
}

template <class P>
NormalEquations linearize(const BasicPoseGraph<P>& graph, const GraphStructure& structure,
                          const std::vector<P>& poses, const std::vector<double>& edge_weights) {
  return Linearizer<P>(graph, structure, edge_weights).at(poses);
}

template GraphStructure structure_of(const PoseGraph&, const Components&, const std::vector<double>&);
template GraphStructure structure_of(const PoseGraph2&, const Components&, const std::vector<double>&);
template void sum_terms(const GraphStructure&, const std::vector<EdgeTerms<1>>&, std::vector<double>&);
template void sum_terms(const GraphStructure&, const std::vector<EdgeTerms<2>>&, std::vector<double>&);
template void sum_terms(const GraphStructure&, const std::vector<EdgeTerms<3>>&, std::vector<double>&);
template void sum_terms(const GraphStructure&, const std::vector<EdgeTerms<4>>&, std::vector<double>&);
template void sum_terms(const GraphStructure&, const std::vector<EdgeTerms<6>>&, std::vector<double>&);
template Eigen::VectorXd times<3>(const BlockPattern&, const std::vector<double>&, const Eigen::VectorXd&);
template Eigen::VectorXd times<4>(const BlockPattern&, const std::vector<double>&, const Eigen::VectorXd&);
template Eigen::VectorXd times<6>(const BlockPattern&, const std::vector<double>&, const Eigen::VectorXd&);
template class Linearizer<Pose>;
template class Linearizer<Pose2>;
template NormalEquations linearize(const PoseGraph&, const GraphStructure&, const std::vector<Pose>&,
                                   const std::vector<double>&);
template NormalEquations linearize(const PoseGraph2&, const GraphStructure&, const std::vector<Pose2>&,
                                   const std::vector<double>&);

}  // namespace adit

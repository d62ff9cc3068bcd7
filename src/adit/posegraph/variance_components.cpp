// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/variance_components.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"
#include "adit/posegraph/factors.hpp"
#include "adit/posegraph/normal_equations.hpp"

namespace adit {
namespace {

// Numbers that fit as stated, to begin with: one measurement in space. Stated variances were found to be
// right within a factor of two or so (decision 0033), which is what six numbers say.
constexpr double kPriorRedundancy = 6.0;
// The standard deviation of a trace of n is the root of 2 n / kNumProbes at most.
constexpr Eigen::Index kNumProbes = 64;
constexpr std::uint64_t kTraceSeed = 17;
constexpr int kBalancingRounds = 10;
constexpr double kSettled = 0.05;  // relative change of a variance that ends the rounds

Eigen::MatrixXd random_signs(Eigen::Index rows) {
  Rng rng(kTraceSeed);
  Eigen::MatrixXd signs(rows, kNumProbes);
  for (double& sign : signs.reshaped()) sign = rng.uniform(-1.0, 1.0) < 0.0 ? -1.0 : 1.0;
  return signs;
}

/// How many numbers of each source the rest of the graph determines, at the graph's poses; nothing where the
/// graph is singular.
template <class P>
std::optional<std::vector<double>> fitted_numbers(const BasicPoseGraph<P>& graph,
                                                  const std::vector<std::size_t>& source_of_edge,
                                                  std::size_t num_sources,
                                                  const std::vector<double>& edge_weights) {
  constexpr int D = P::kDof;
  using Matrix = typename P::Jacobian;
  const GraphStructure structure =
      structure_of(graph, connected_components(graph, edge_weights), edge_weights);
  const std::vector<P> poses = poses_of(graph);
  BlockCholesky cholesky(analyze(structure.pattern), D);
  if (cholesky.factorize(linearize(graph, structure, poses, edge_weights).values)) return std::nullopt;
  const auto at = [](std::size_t i) { return static_cast<Eigen::Index>(i) * D; };
  const Eigen::MatrixXd signs = random_signs(at(structure.active_edges.size()));
  // The Jacobians of an edge's normalised residual; those of anchors are left out.
  const auto for_each_end = [&](std::size_t a, const auto& use) {
    const std::size_t e = structure.active_edges[a];
    const auto& edge = graph.edges[e];
    const BetweenFactor<P> f = linearize(edge.T_from_to, poses[edge.from], poses[edge.to]);
    const double weight = edge_weights.empty() ? 1.0 : edge_weights[e];
    const Matrix root = Matrix(weight * edge.information).llt().matrixU();
    for (const auto& [node, jacobian] : {std::pair(edge.from, f.d_from), std::pair(edge.to, f.d_to)}) {
      const std::size_t v = structure.variable_of_node[node];
      if (v != GraphStructure::kFixed) use(at(v), Matrix(root * jacobian));
    }
  };
  Eigen::MatrixXd projected = Eigen::MatrixXd::Zero(at(structure.node_of_variable.size()), kNumProbes);
  for (std::size_t a = 0; a < structure.active_edges.size(); ++a)
    for_each_end(a, [&](Eigen::Index row, const Matrix& jacobian) {
      projected.middleRows<D>(row) += jacobian.transpose() * signs.middleRows<D>(at(a));
    });
  const Eigen::MatrixXd moved = cholesky.solve(projected);
  std::vector<double> fitted(num_sources, 0.0);
  for (std::size_t a = 0; a < structure.active_edges.size(); ++a)
    for_each_end(a, [&](Eigen::Index row, const Matrix& jacobian) {
      fitted[source_of_edge[structure.active_edges[a]]] +=
          (signs.middleRows<D>(at(a)).array() * (jacobian * moved.middleRows<D>(row)).array()).sum() /
          kNumProbes;
    });
  return fitted;
}

/// Of the sources in `solved`, whose information was divided by `components`; false once they stay.
template <class P>
bool improve(const BasicPoseGraph<P>& graph, const BasicPoseGraph<P>& solved,
             const std::vector<std::size_t>& source_of_edge, const std::vector<double>& edge_weights,
             double least_variance, std::vector<VarianceComponent>& components) {
  const auto fitted = fitted_numbers(solved, source_of_edge, components.size(), edge_weights);
  if (!fitted) return false;
  std::vector<VarianceComponent> next(components.size());
  const std::vector<double> costs = edge_costs(graph, poses_of(solved));
  for (std::size_t e = 0; e < costs.size(); ++e) {
    const double weight = edge_weights.empty() ? 1.0 : edge_weights[e];
    if (weight <= 0.0) continue;
    VarianceComponent& component = next[source_of_edge[e]];
    component.chi2 += weight * costs[e];
    ++component.num_edges;
  }
  bool changes = false;
  for (std::size_t s = 0; s < next.size(); ++s) {
    VarianceComponent& c = next[s];
    c.redundancy = std::max(0.0, static_cast<double>(c.num_edges) * P::kDof - (*fitted)[s]);
    c.variance = std::max(least_variance, (kPriorRedundancy + c.chi2) / (kPriorRedundancy + c.redundancy));
    changes = changes || std::abs(c.variance / components[s].variance - 1.0) > kSettled;
  }
  components = std::move(next);
  return changes;
}

}  // namespace

template <class P>
BalancedSolution<P> optimize_balanced(const BasicPoseGraph<P>& graph,
                                      const std::vector<std::size_t>& source_of_edge, std::size_t num_sources,
                                      const OptimizerConfig& config, const std::vector<double>& edge_weights,
                                      double least_variance) {
  ADIT_CHECK(source_of_edge.size() == graph.edges.size(), "a source for each edge");
  ADIT_CHECK(std::ranges::all_of(source_of_edge, [&](std::size_t s) { return s < num_sources; }),
             "sources are numbered from 0 to num_sources - 1");
  BasicPoseGraph<P> solved = graph;
  BalancedSolution<P> out{{}, std::vector<VarianceComponent>(num_sources)};
  OptimizerConfig from_there = config;
  from_there.initialization = SolveStart::given;
  for (int round = 0; round < kBalancingRounds; ++round) {
    Solution<P> solution = optimize(solved, from_there, edge_weights);
    solution.iterations += out.solution.iterations;
    if (round > 0) solution.cost_initial = out.solution.cost_initial;
    out.solution = std::move(solution);
    if (!out.solution.ok()) break;
    for (std::size_t i = 0; i < solved.nodes.size(); ++i) solved.nodes[i].pose = out.solution.poses[i];
    if (!improve(graph, solved, source_of_edge, edge_weights, least_variance, out.components)) break;
    for (std::size_t e = 0; e < graph.edges.size(); ++e)
      solved.edges[e].information = graph.edges[e].information / out.components[source_of_edge[e]].variance;
  }
  return out;
}

template BalancedSolution<Pose> optimize_balanced(const PoseGraph&, const std::vector<std::size_t>&,
                                                  std::size_t, const OptimizerConfig&,
                                                  const std::vector<double>&, double);
template BalancedSolution<Pose2> optimize_balanced(const PoseGraph2&, const std::vector<std::size_t>&,
                                                   std::size_t, const OptimizerConfig&,
                                                   const std::vector<double>&, double);

}  // namespace adit

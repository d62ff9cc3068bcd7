// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/condensed_graph.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "adit/core/decompositions.hpp"

namespace adit {
namespace {

constexpr std::size_t kNoEdge = std::numeric_limits<std::size_t>::max();

bool is_step(const PoseGraph::Edge& edge) {
  return edge.kind == EdgeKind::odometry && edge.from + 1 == edge.to;
}

/// Of each node the step that ends at it.
std::vector<std::size_t> steps_to(const PoseGraph& graph) {
  std::vector<std::size_t> step(graph.nodes.size(), kNoEdge);
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    if (is_step(graph.edges[e])) step[graph.edges[e].to] = e;
  }
  return step;
}

/// Least squares with all loops, where every edge then errs by no more than its stated noise allows.
std::optional<Solution<Pose>> all_as_stated(const PoseGraph& graph, const GncConfig& config) {
  Solution<Pose> solved = optimize(graph, config.optimizer);
  if (!solved.ok()) return std::nullopt;
  const double bound = chi2_quantile(config.inlier_probability, Pose::kDof);
  for (const double chi2 : edge_costs(graph, solved.poses))
    if (chi2 > bound) return std::nullopt;
  return solved;
}

}  // namespace

CondensedGraph condense(const PoseGraph& whole) {
  const std::vector<std::size_t> step = steps_to(whole);
  std::vector<bool> keep(whole.nodes.size(), false);
  for (std::size_t i = 0; i < whole.nodes.size(); ++i) keep[i] = step[i] == kNoEdge;
  for (const PoseGraph::Edge& edge : whole.edges) {
    if (!is_step(edge)) keep[edge.from] = keep[edge.to] = true;
  }

  CondensedGraph out;
  std::vector<std::size_t> place(whole.nodes.size(), 0);
  Pose T_kept_node;
  Matrix6 covariance = Matrix6::Zero();
  for (std::size_t i = 0; i < whole.nodes.size(); ++i) {
    if (step[i] != kNoEdge) {
      const PoseGraph::Edge& edge = whole.edges[step[i]];
      const Matrix6 carry = edge.T_from_to.inverse().adjoint();
      covariance = carry * covariance * carry.transpose() + inverse(edge.information);
      T_kept_node = T_kept_node * edge.T_from_to;
    }
    if (!keep[i]) continue;
    place[i] = out.graph.nodes.size();
    out.graph.nodes.push_back(whole.nodes[i]);
    out.kept.push_back(i);
    if (step[i] != kNoEdge) {
      out.graph.edges.push_back(
          {place[i] - 1, place[i], T_kept_node, covariance.inverse(), EdgeKind::odometry});
    }
    T_kept_node = Pose();
    covariance.setZero();
  }
  for (const PoseGraph::Edge& edge : whole.edges) {
    if (is_step(edge)) continue;
    PoseGraph::Edge& moved = out.graph.edges.emplace_back(edge);
    moved.from = place[edge.from];
    moved.to = place[edge.to];
  }
  return out;
}

std::vector<Pose> spread(const PoseGraph& whole, const CondensedGraph& condensed,
                         const std::vector<Pose>& poses) {
  const std::vector<std::size_t> step = steps_to(whole);
  std::vector<Pose> out(whole.nodes.size());
  for (std::size_t k = 0; k < condensed.kept.size(); ++k) {
    const std::size_t begin = condensed.kept[k];
    const bool last = k + 1 == condensed.kept.size();
    const std::size_t end = last ? whole.nodes.size() : condensed.kept[k + 1];
    out[begin] = poses[k];
    for (std::size_t i = begin + 1; i < end; ++i) out[i] = out[i - 1] * whole.edges[step[i]].T_from_to;
    if (last || step[end] == kNoEdge) continue;  // a loose end
    const Pose T_world_end = out[end - 1] * whole.edges[step[end]].T_from_to;
    const Vector6 misfit = (T_world_end.inverse() * poses[k + 1]).log();
    for (std::size_t i = begin + 1; i < end; ++i) {
      const double share = static_cast<double>(i - begin) / static_cast<double>(end - begin);
      out[i] = T_world_end * Pose::exp(misfit * share) * (T_world_end.inverse() * out[i]);
    }
  }
  return out;
}

Solution<Pose> solve_robustly(const PoseGraph& whole, const GncConfig& config, LoopsAre loops) {
  const CondensedGraph condensed = condense(whole);
  std::optional<Solution<Pose>> all;
  if (loops == LoopsAre::confirmed) all = all_as_stated(condensed.graph, config);
  const Solution<Pose> found = all ? *std::move(all) : optimize_gnc(condensed.graph, config);
  if (!found.ok()) return optimize_gnc(whole, config);  // which says why in terms of the whole graph
  PoseGraph placed = whole;
  const std::vector<Pose> start = spread(whole, condensed, found.poses);
  for (std::size_t i = 0; i < start.size(); ++i) placed.nodes[i].pose = start[i];
  std::vector<double> weights(whole.edges.size(), 1.0);
  const auto num_others = static_cast<std::size_t>(
      std::ranges::count_if(whole.edges, [](const PoseGraph::Edge& edge) { return !is_step(edge); }));
  std::size_t next = found.edge_weights.size() - num_others;
  for (std::size_t e = 0; e < weights.size(); ++e) {
    if (!is_step(whole.edges[e])) weights[e] = found.edge_weights[next++];
  }
  OptimizerConfig from_there = config.optimizer;
  from_there.initialization = SolveStart::given;
  Solution<Pose> solved = optimize(placed, from_there, weights);
  solved.edge_weights = std::move(weights);
  solved.iterations += found.iterations;
  solved.cost_initial = found.cost_initial;
  solved.notes.insert(solved.notes.begin(), found.notes.begin(), found.notes.end());
  return solved;
}

}  // namespace adit

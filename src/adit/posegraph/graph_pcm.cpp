// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/graph_pcm.hpp"

#include <map>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/decompositions.hpp"

namespace adit {
namespace {

Matrix6 step_covariance(const Matrix6& information) {
  const std::optional<Matrix6> covariance = inverse_of_positive_definite(information);
  ADIT_CHECK(covariance, "an odometry edge's information matrix is positive definite");
  return *covariance;
}

// Seen from the other end: T_b_a with the information of its own right perturbation.
PcmLoop reversed(const PcmLoop& loop) {
  const Matrix6 back = loop.T_a_b.inverse().adjoint();
  return {loop.b, loop.a, loop.T_a_b.inverse(), back.transpose() * loop.information * back};
}

struct LoopSet {
  std::vector<PcmLoop> loops;
  std::vector<std::size_t> edges;
};

}  // namespace

GraphPcm graph_pcm(const PoseGraph& graph, const PcmConfig& config) {
  const std::vector<OdometryPath> paths = odometry_paths(graph);
  const std::vector<PlaceOnPath> places = places_on(paths, graph.nodes.size());
  std::map<std::pair<std::size_t, std::size_t>, LoopSet> sets;
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    const auto& edge = graph.edges[e];
    if (edge.kind != EdgeKind::loop) continue;
    const PlaceOnPath from = places[edge.from];
    const PlaceOnPath to = places[edge.to];
    const PcmLoop loop{from.position, to.position, edge.T_from_to, edge.information};
    LoopSet& set = sets[std::minmax(from.path, to.path)];
    set.loops.push_back(from.path <= to.path ? loop : reversed(loop));
    set.edges.push_back(e);
  }
  std::vector<OdometryChain> chains;
  for (const OdometryPath& path : paths) chains.push_back(chain_along(graph, path, step_covariance));
  GraphPcm result{std::vector<double>(graph.edges.size(), 1.0), true};
  for (const auto& [pair, set] : sets) {
    const PcmResult found = pcm(chains[pair.first], chains[pair.second], set.loops, config);
    for (const std::size_t e : set.edges) result.edge_weights[e] = 0.0;
    for (const std::size_t i : found.largest) result.edge_weights[set.edges[i]] = 1.0;
    result.optimal = result.optimal && found.optimal;
  }
  return result;
}

}  // namespace adit

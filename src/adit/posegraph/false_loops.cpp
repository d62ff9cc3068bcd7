// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/false_loops.hpp"

#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"
#include "adit/posegraph/optimizer.hpp"

namespace adit {
namespace {

constexpr std::size_t kRun = 10;  // loops per cluster

template <class P>
std::vector<typename BasicPoseGraph<P>::Edge> loops_of(const BasicPoseGraph<P>& graph) {
  std::vector<typename BasicPoseGraph<P>::Edge> loops;
  for (const auto& edge : graph.edges)
    if (edge.kind == EdgeKind::loop) loops.push_back(edge);
  return loops;
}

// Odometry from node i to i + 1; null where there is none.
template <class P>
std::vector<const P*> steps_of(const BasicPoseGraph<P>& graph) {
  std::vector<const P*> steps(graph.nodes.size(), nullptr);
  for (const auto& edge : graph.edges)
    if (edge.kind == EdgeKind::odometry && edge.to == edge.from + 1) steps[edge.from] = &edge.T_from_to;
  return steps;
}

}  // namespace

template <class P>
LabelledGraph<P> with_false_loops(BasicPoseGraph<P> graph, double share, FalseLoops kind,
                                  std::uint64_t seed) {
  ADIT_CHECK(share >= 0.0 && share < 1.0, "the share of false loops is in [0, 1)");
  const std::size_t n = graph.nodes.size();
  const auto loops = loops_of(graph);
  const std::vector<const P*> steps = steps_of(graph);
  const auto num_false = static_cast<std::size_t>(static_cast<double>(loops.size()) * share / (1.0 - share));
  ADIT_CHECK(num_false == 0 || n >= 3, "a false loop needs nodes that are two apart");
  std::vector<typename BasicPoseGraph<P>::Edge> added;
  Rng rng(seed);
  while (added.size() < num_false) {
    auto edge = loops[rng.below(loops.size())];
    edge.from = rng.below(n);
    edge.to = rng.below(n);
    if (edge.from + 1 >= edge.to) continue;
    added.push_back(edge);
    for (std::size_t i = 1; kind == FalseLoops::clustered && i < kRun && added.size() < num_false; ++i) {
      if (edge.to + 1 >= n || steps[edge.from] == nullptr || steps[edge.to] == nullptr) break;
      edge.T_from_to = steps[edge.from]->inverse() * edge.T_from_to * *steps[edge.to];
      ++edge.from;
      ++edge.to;
      added.push_back(edge);
    }
  }
  const std::size_t num_true = graph.edges.size();
  graph.edges.insert(graph.edges.end(), added.begin(), added.end());
  return {std::move(graph), num_true};
}

template <class P>
std::size_t drop_true_by_chance(LabelledGraph<P>& labelled, const std::vector<P>& poses, double bound) {
  const std::vector<double> costs = edge_costs(labelled.graph, poses);
  auto& edges = labelled.graph.edges;
  std::size_t kept = labelled.num_true;
  for (std::size_t e = labelled.num_true; e < edges.size(); ++e)
    if (costs[e] > bound) edges[kept++] = edges[e];
  const std::size_t dropped = edges.size() - kept;
  edges.resize(kept);
  return dropped;
}

template <class P>
BasicPoseGraph<P> with_every_nth_loop(const BasicPoseGraph<P>& graph, std::size_t n) {
  ADIT_CHECK(n > 0, "every first loop, or every second, ...");
  BasicPoseGraph<P> out{graph.nodes, {}};
  std::size_t loop = 0;
  for (const auto& edge : graph.edges)
    if (edge.kind == EdgeKind::odometry || loop++ % n == 0) out.edges.push_back(edge);
  return out;
}

template LabelledGraph<Pose> with_false_loops(PoseGraph, double, FalseLoops, std::uint64_t);
template LabelledGraph<Pose2> with_false_loops(PoseGraph2, double, FalseLoops, std::uint64_t);
template std::size_t drop_true_by_chance(LabelledGraph<Pose>&, const std::vector<Pose>&, double);
template std::size_t drop_true_by_chance(LabelledGraph<Pose2>&, const std::vector<Pose2>&, double);
template PoseGraph with_every_nth_loop(const PoseGraph&, std::size_t);
template PoseGraph2 with_every_nth_loop(const PoseGraph2&, std::size_t);

}  // namespace adit

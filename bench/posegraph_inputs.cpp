// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "posegraph_inputs.hpp"

#include "adit/core/rng.hpp"
#include "adit/io/g2o.hpp"
#include "harness/bench_case.hpp"

namespace adit::bench {

std::variant<PoseGraph, PoseGraph2> shared_graph(const std::string& name) {
  auto file = read_g2o(shared_data("g2o/single/" + name + ".g2o"));
  if (!file) throw Skipped{file.error().message};
  if (name == "cubicle") {
    for (auto& edge : std::get<PoseGraph>(file->graph).edges) {
      edge.information.topRightCorner<3, 3>().setZero();
      edge.information.bottomLeftCorner<3, 3>().setZero();
    }
  }
  return file->graph;
}

PoseGraph with_false_loops(PoseGraph graph, double share, FalseLoops kind, std::size_t& num_true) {
  constexpr std::size_t kRun = 10;
  num_true = graph.edges.size();
  const std::size_t n = graph.nodes.size();
  std::vector<PoseGraph::Edge> loops;
  std::vector<const PoseGraph::Edge*> step(n, nullptr);  // odometry from node i to i + 1
  for (const auto& edge : graph.edges) {
    if (edge.kind == EdgeKind::loop) loops.push_back(edge);
  }
  for (std::size_t e = 0; e < num_true; ++e) {
    const auto& edge = graph.edges[e];
    if (edge.kind == EdgeKind::odometry && edge.to == edge.from + 1) step[edge.from] = &graph.edges[e];
  }
  const auto num_false = static_cast<std::size_t>(static_cast<double>(loops.size()) * share / (1.0 - share));
  std::vector<PoseGraph::Edge> added;
  Rng rng(1);
  while (added.size() < num_false) {
    PoseGraph::Edge edge = loops[rng.below(loops.size())];
    edge.from = rng.below(n);
    edge.to = rng.below(n);
    if (edge.from + 1 >= edge.to) continue;
    added.push_back(edge);
    for (std::size_t i = 1; kind == FalseLoops::clustered && i < kRun && added.size() < num_false; ++i) {
      if (edge.to + 1 >= n || step[edge.from] == nullptr || step[edge.to] == nullptr) break;
      edge.T_from_to = step[edge.from]->T_from_to.inverse() * edge.T_from_to * step[edge.to]->T_from_to;
      ++edge.from;
      ++edge.to;
      added.push_back(edge);
    }
  }
  graph.edges.insert(graph.edges.end(), added.begin(), added.end());
  return graph;
}

PoseGraph thinned(const PoseGraph& graph) {
  PoseGraph out{graph.nodes, {}};
  std::size_t loop = 0;
  for (const auto& edge : graph.edges) {
    if (edge.kind == EdgeKind::odometry || loop++ % 10 == 0) out.edges.push_back(edge);
  }
  return out;
}

}  // namespace adit::bench

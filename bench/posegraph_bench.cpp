// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <benchmark/benchmark.h>

#include <filesystem>
#include <optional>
#include <string>

#include "adit/core/rng.hpp"
#include "adit/io/g2o.hpp"
#include "adit/posegraph/gnc.hpp"
#include "adit/posegraph/max_clique.hpp"
#include "adit/posegraph/optimizer.hpp"
#include "adit/posegraph/pcm.hpp"

namespace adit {
namespace {

std::optional<PoseGraph> shared_graph(benchmark::State& state, const std::string& name) {
  const auto file = read_g2o(std::filesystem::path(ADIT_SHARED_DATA) / "g2o/single" / (name + ".g2o"));
  if (file) return std::get<PoseGraph>(file->graph);
  state.SkipWithError(file.error().message.c_str());
  return std::nullopt;
}

void optimize_graph(benchmark::State& state, const char* name, const char* initialization) {
  const auto graph = shared_graph(state, name);
  if (!graph) return;
  OptimizerConfig config;
  config.initialization = initialization;
  Solution<Pose> solution;
  for (auto _ : state) solution = optimize(*graph, config);
  state.counters["chi2"] = solution.cost_final;
  state.counters["iterations"] = solution.iterations;
}
BENCHMARK_CAPTURE(optimize_graph, sphere2500_chordal, "sphere2500", "chordal")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(optimize_graph, sphere2500_none, "sphere2500", "none")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(optimize_graph, torus3D_chordal, "torus3D", "chordal")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(optimize_graph, torus3D_none, "torus3D", "none")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(optimize_graph, parking_garage_chordal, "parking-garage", "chordal")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(optimize_graph, parking_garage_none, "parking-garage", "none")
    ->Unit(benchmark::kMillisecond);

/// False loops copy a true measurement onto a wrong pair, until they are `share` of all loops. Returns how
/// many.
std::size_t add_false_loops(double share, PoseGraph& graph) {
  std::vector<PoseGraph::Edge> loops;
  for (const auto& edge : graph.edges) {
    if (edge.kind == EdgeKind::loop) loops.push_back(edge);
  }
  const auto num_false = static_cast<std::size_t>(static_cast<double>(loops.size()) * share / (1.0 - share));
  Rng rng(1);
  for (std::size_t added = 0; added < num_false;) {
    PoseGraph::Edge edge = loops[rng.below(loops.size())];
    edge.from = rng.below(graph.nodes.size());
    edge.to = rng.below(graph.nodes.size());
    if (edge.from + 1 >= edge.to) continue;
    graph.edges.push_back(edge);
    ++added;
  }
  return num_false;
}

void gnc_small_grid(benchmark::State& state) {
  auto graph = shared_graph(state, "smallGrid3D");
  if (!graph) return;
  const std::size_t num_true = graph->edges.size();
  const std::size_t num_false = add_false_loops(0.01 * static_cast<double>(state.range(0)), *graph);
  Solution<Pose> solution;
  for (auto _ : state) solution = optimize_gnc(*graph);
  double true_lost = 0.0;
  double false_kept = 0.0;
  for (std::size_t e = 0; e < graph->edges.size(); ++e) {
    (e < num_true ? true_lost : false_kept) +=
        e < num_true ? 1.0 - solution.edge_weights[e] : solution.edge_weights[e];
  }
  state.counters["false_loops"] = static_cast<double>(num_false);
  state.counters["false_kept"] = false_kept;
  state.counters["true_lost"] = true_lost;
}
BENCHMARK(gnc_small_grid)->Arg(30)->Arg(50)->Unit(benchmark::kMillisecond);

void max_clique_random(benchmark::State& state) {
  Rng rng(2);
  BitGraph graph(static_cast<std::size_t>(state.range(0)));
  for (std::size_t a = 0; a < graph.num_vertices(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      if (rng.uniform() < 0.01 * static_cast<double>(state.range(1))) graph.add_edge(a, b);
    }
  }
  Clique clique;
  for (auto _ : state) clique = max_clique(graph, 1'000'000);
  state.counters["size"] = static_cast<double>(clique.vertices.size());
  state.counters["optimal"] = clique.optimal ? 1.0 : 0.0;
}
BENCHMARK(max_clique_random)
    ->Args({500, 30})
    ->Args({500, 50})
    ->Args({500, 90})
    ->Unit(benchmark::kMillisecond);

/// A robot that wanders with noisy steps.
OdometryChain wandering_chain(Rng& rng, std::size_t num_keyframes) {
  std::vector<Pose> poses(1);
  const Matrix6 covariance = Matrix6::Identity() * 1e-4;
  while (poses.size() < num_keyframes)
    poses.push_back(poses.back() * Pose::planar(0.5, 0.0, 0.05 * rng.normal()));
  return {poses, std::vector<Matrix6>(num_keyframes - 1, covariance)};
}

void pcm_of_loops(benchmark::State& state) {
  Rng rng(3);
  const OdometryChain a = wandering_chain(rng, 900);
  const OdometryChain b = wandering_chain(rng, 900);
  std::vector<PcmLoop> loops;
  for (std::int64_t i = 0; i < state.range(0); ++i) {
    PcmLoop loop{rng.below(a.size()), rng.below(b.size()), Pose(), Matrix6::Identity() * 1e4};
    // Half of them agree on where the second robot's frame lies, the others on nothing.
    const Pose T_a_b =
        i % 2 == 0 ? Pose() : Pose::planar(rng.uniform(-50, 50), rng.uniform(-50, 50), rng.normal());
    loop.T_a_b = a.pose(loop.a).inverse() * T_a_b * b.pose(loop.b);
    loops.push_back(loop);
  }
  PcmResult result;
  for (auto _ : state) result = pcm(a, b, loops);
  state.counters["kept"] = static_cast<double>(result.largest.size());
}
BENCHMARK(pcm_of_loops)->Arg(300)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Pose graphs to the minimum, with and without false loops, at once and loop by loop.
#include <algorithm>
#include <fstream>
#include <memory>
#include <stdexcept>

#include "adit/core/format.hpp"
#include "adit/io/g2o.hpp"
#include "adit/posegraph/false_loops.hpp"
#include "adit/posegraph/gnc.hpp"
#include "adit/posegraph/incremental.hpp"
#include "adit/posegraph/optimizer.hpp"
#include "harness/bench_case.hpp"
#include "posegraph_inputs.hpp"

namespace adit::bench {
namespace {

Work optimizing(const std::string& name, SolveStart initialization) {
  OptimizerConfig config;
  config.initialization = initialization;
  return std::visit(
      [&](auto graph) -> Work {
        return [graph = std::move(graph), config] {
          const auto solution = optimize(graph, config);
          return Figures{{"chi2", solution.cost_final},
                         {"iterations", static_cast<double>(solution.iterations)}};
        };
      },
      shared_graph(name));
}

About timed_from(const std::string& start) {
  return {.timed = "from the graph in memory to the minimum: analysis of its structure, start (" + start +
                   "), all iterations"};
}

// Each side at its best, and then both from the same start.
const struct GraphCases {
  GraphCases() {
    for (const BenchGraph& graph : kGraphs) {
      const std::string name = graph.name;
      const auto add = [&](const std::string& suffix, const std::string& work, const std::string& peer,
                           double aim, SolveStart initialization, const std::string& start) {
        const std::string case_name = "posegraph/" + name + suffix;
        Case({.name = case_name,
              .work = work,
              .scene = name + ", " + graph.size,
              .num_threads = 2,
              .peer = peer,
              .aim = aim});
        Side(
            case_name, "adit", [=] { return optimizing(name, initialization); }, timed_from(start));
      };
      add("", "least squares, each side from its best start", graph.best_ceres, 2.0, SolveStart::better,
          "the better of the file's guess and the chordal relaxation");
      add("_from_guess", "least squares, both from the guess in the file", "ceres", 0.0, SolveStart::given,
          "the guess in the file");
      if (name != "city10000")
        add("_from_chordal", "least squares, both from the chordal relaxation", "ceres", 0.0,
            SolveStart::chordal, "the chordal relaxation");
    }
  }
} graph_cases;

// Positions against the optimum without false loops; both hold the first node where it is.
double largest_distance_m(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, (a[i].translation() - b[i].translation()).norm());
  return largest;
}

struct GncCase {
  std::string title;
  std::string graph;
  bool thin;
  double share;
  FalseLoops kind;
};
std::vector<GncCase> gnc_case_list() {
  std::vector<GncCase> out;
  const auto add = [&](const std::string& graph, bool thin) {
    for (const int percent : {30, 50}) {
      for (const FalseLoops kind : {FalseLoops::random, FalseLoops::clustered}) {
        out.push_back({format("{}{}_{}_{}", graph, thin ? "_thin" : "",
                              kind == FalseLoops::random ? "random" : "clustered", percent),
                       graph, thin, 0.01 * percent, kind});
      }
    }
  };
  add("smallGrid3D", false);
  add("sphere2500", true);
  add("sphere2500", false);
  add("parking-garage", false);
  return out;
}

PoseGraph clean(const GncCase& c) {
  PoseGraph graph = std::get<PoseGraph>(shared_graph(c.graph));
  return c.thin ? with_every_nth_loop(graph, 10) : graph;
}
LabelledGraph<Pose> spoiled(const GncCase& c) { return with_false_loops(clean(c), c.share, c.kind, 1); }

Work rejecting(const GncCase& c) {
  const std::vector<Pose> optimum = optimize(clean(c)).poses;
  return [optimum, labelled = spoiled(c)] {
    const auto& [graph, num_true] = labelled;
    const Solution<Pose> solution = optimize_gnc(graph);
    Figures figures{{"false", static_cast<double>(graph.edges.size() - num_true)},
                    {"false_kept", 0.0},
                    {"true", 0.0},
                    {"true_lost", 0.0}};
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
      const bool is_true = e < num_true;
      if (is_true && graph.edges[e].kind == EdgeKind::loop) figures["true"] += 1.0;
      figures[is_true ? "true_lost" : "false_kept"] +=
          is_true ? 1.0 - solution.edge_weights[e] : solution.edge_weights[e];
    }
    figures["off_m"] = largest_distance_m(solution.poses, optimum);
    return figures;
  };
}

const struct GncCases {
  GncCases() {
    for (const GncCase& c : gnc_case_list()) {
      Case({.name = "gnc/" + c.title,
            .work = "which loops are false, and the poses",
            .scene = c.graph + (c.thin ? ", one loop in ten" : "") + ", false loops added with seed 1",
            .num_threads = 2,
            .peer = "gtsam",
            .aim = 10.0});
      Side("gnc/" + c.title, "adit", [c] { return rejecting(c); });
    }
  }
} gnc_cases;

// One run: the keyframes up to the next loop, and the update that it calls for.
Work feeding(std::size_t num_keyframes) {
  constexpr std::size_t kSpare = 1500;  // keyframes whose loops are left for the runs
  struct Feed {
    PoseGraph graph;
    IncrementalOptimizer<Pose> optimizer;
    std::size_t edge = 0;
    bool next_loop() {  // false when it has come to the end
      while (edge < graph.edges.size()) {
        const auto& e = graph.edges[edge++];
        if (e.kind == EdgeKind::odometry)
          optimizer.add_node(graph.nodes[e.to].key, optimizer.poses()[e.from] * e.T_from_to);
        optimizer.add_edge(e);
        if (e.kind == EdgeKind::loop) return true;
      }
      return false;
    }
  };
  auto feed = std::make_shared<Feed>();
  feed->graph = wandering_graph(num_keyframes + kSpare);
  feed->optimizer.add_node(0, feed->graph.nodes[0].pose);
  // The past goes in with few updates: every hundredth loop.
  for (int loop = 1; feed->next_loop() && feed->optimizer.poses().size() < num_keyframes; ++loop) {
    if (loop % 100 == 0) (void)feed->optimizer.update();
  }
  (void)feed->optimizer.update();
  return [feed] {
    if (!feed->next_loop()) throw std::runtime_error("no loop is left: fewer rounds, please");
    const auto update = feed->optimizer.update();
    return Figures{{"chi2", update.cost},
                   {"iterations", static_cast<double>(update.iterations)},
                   {"keyframes", static_cast<double>(feed->optimizer.poses().size())},
                   {"supernodes_renewed", static_cast<double>(update.num_renewed)},
                   {"edges_evaluated", static_cast<double>(update.num_evaluated)}};
  };
}

const struct IncrementalCases {
  IncrementalCases() {
    Case({.name = "posegraph/incremental_10k",
          .work = "a loop arrives: update to convergence",
          .scene = "a mine of square blocks, 10,000 keyframes, a loop at every tenth revisit",
          .num_threads = 2,
          .peer = "gtsam"});
    Side("posegraph/incremental_10k", "adit", [] { return feeding(10'000); });
    Growth("posegraph/incremental", "Update to convergence when a loop arrives", "keyframes so far",
           {1000, 3000, 10'000, 30'000}, [](double size) { return feeding(static_cast<std::size_t>(size)); });
    Growth("posegraph/batch", "The same graph solved from dead reckoning at once", "keyframes",
           {1000, 3000, 10'000, 30'000}, [](double size) -> Work {
             auto graph = std::make_shared<PoseGraph>(wandering_graph(static_cast<std::size_t>(size)));
             return [graph] {
               const auto solution = optimize(*graph);
               return Figures{{"chi2", solution.cost_final}};
             };
           });
  }
} incremental_cases;

// What programs outside need to do the same: every graph as a g2o file; of the graphs with false loops also
// how many of the edges, which come first, are true.
void export_graphs(const std::filesystem::path& folder) {
  const auto write = [&](const std::string& name, const auto& graph) {
    std::ofstream file(folder / (name + ".g2o"));
    write_g2o(file, graph);
  };
  for (const BenchGraph& graph : kGraphs)
    std::visit([&](const auto& g) { write(graph.name, g); }, shared_graph(graph.name));
  write("incremental_10k", wandering_graph(11'500));
  for (const GncCase& c : gnc_case_list()) {
    const LabelledGraph<Pose> labelled = spoiled(c);
    write(c.title, labelled.graph);
    write(c.title + "_clean", clean(c));
    std::ofstream(folder / (c.title + ".txt")) << labelled.num_true << "\n";
  }
}
const Export exported("posegraph", export_graphs);

}  // namespace
}  // namespace adit::bench

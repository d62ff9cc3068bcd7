// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Pose graphs from the file's guess to the minimum; reading is not timed, analysis of the structure is.
#include "adit/core/format.hpp"
#include "adit/posegraph/gnc.hpp"
#include "adit/posegraph/optimizer.hpp"
#include "harness/bench_case.hpp"
#include "posegraph_inputs.hpp"

namespace adit::bench {
namespace {

Work optimizing(const std::string& name) {
  return std::visit(
      [](auto graph) -> Work {
        return [graph = std::move(graph)] {
          const auto solution = optimize(graph);
          return Figures{{"chi2", solution.cost_final},
                         {"iterations", static_cast<double>(solution.iterations)}};
        };
      },
      shared_graph(name));
}

const struct GraphCases {
  GraphCases() {
    for (const std::string name : kGraphNames) {
      Case({.name = "posegraph/" + name,
            .work = "least squares from the guess in the file",
            .peer = "ceres",
            .aim = 4.0});
      Side("posegraph/" + name, "adit", [name] { return optimizing(name); });
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

Work rejecting(const std::string& name, bool thin, double share, FalseLoops kind) {
  PoseGraph clean = std::get<PoseGraph>(shared_graph(name));
  if (thin) clean = thinned(clean);
  const std::vector<Pose> optimum = optimize(clean).poses;
  std::size_t num_true = 0;
  PoseGraph graph = with_false_loops(clean, share, kind, num_true);
  return [=, graph = std::move(graph)] {
    const Solution<Pose> solution = optimize_gnc(graph);
    Figures figures{{"false", static_cast<double>(graph.edges.size() - num_true)}};
    double num_loops = 0.0;
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
      if (e < num_true && graph.edges[e].kind == EdgeKind::loop) num_loops += 1.0;
      if (e < num_true)
        figures["true_lost"] += 1.0 - solution.edge_weights[e];
      else
        figures["false_kept"] += solution.edge_weights[e];
    }
    figures["true"] = num_loops;
    figures["off_m"] = largest_distance_m(solution.poses, optimum);
    return figures;
  };
}

const struct GncCases {
  GncCases() {
    for (const std::string name : {"smallGrid3D", "sphere2500", "parking-garage"}) {
      for (const bool thin : {false, true}) {
        if (thin && name != "sphere2500") continue;
        for (const int percent : {30, 50}) {
          for (const FalseLoops kind : {FalseLoops::random, FalseLoops::clustered}) {
            const std::string title = format("gnc/{}{}_{}_{}", name, thin ? "_thin" : "",
                                             kind == FalseLoops::random ? "random" : "clustered", percent);
            Case({.name = title,
                  .work = "which loops are false, and the poses",
                  .peer = "gtsam",
                  .aim = 10.0});
            Side(title, "adit", [=] { return rejecting(name, thin, 0.01 * percent, kind); });
          }
        }
      }
    }
  }
} gnc_cases;

}  // namespace
}  // namespace adit::bench

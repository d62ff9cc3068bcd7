// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/loop_study.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "adit/core/angles.hpp"
#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/posegraph/false_loops.hpp"
#include "adit/study/processor_time.hpp"

namespace adit {
namespace {

/// The optimum of the true edges.
template <class P>
struct Reference {
  std::vector<P> poses;
  int parts = 1;
};

template <class P>
int num_parts(const BasicPoseGraph<P>& graph, const std::vector<double>& edge_weights = {}) {
  return static_cast<int>(connected_components(graph, edge_weights).anchors.size());
}

template <class P>
Result<Reference<P>> solved(const BasicPoseGraph<P>& clean, const OptimizerConfig& config) {
  Solution<P> solution = optimize(clean, config);
  if (!solution.ok()) return fail(format("{}: {}", to_string(solution.status), solution.reason));
  return Reference<P>{std::move(solution.poses), num_parts(clean)};
}

/// Both solutions hold the first node of each part where it is.
template <class P>
double largest_distance_m(const std::vector<P>& a, const std::vector<P>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i)
    largest = std::max(largest, (a[i].translation() - b[i].translation()).norm());
  return largest;
}

template <class P>
std::size_t num_loops(const BasicPoseGraph<P>& graph) {
  return static_cast<std::size_t>(
      std::ranges::count_if(graph.edges, [](const auto& edge) { return edge.kind == EdgeKind::loop; }));
}

template <class P>
struct Attempt {
  Solution<P> solution;
  std::string reason;  ///< Why there is no solution; empty where there is one.
  bool is_optimal = true;
};

Attempt<Pose2> with_pcm(const PoseGraph2&, const LoopStudy&) {
  return {{}, "PCM is implemented for 3-D graphs, and this one is 2-D"};
}

Attempt<Pose> with_pcm(const PoseGraph& graph, const LoopStudy& study) {
  const bool all_definite = std::ranges::all_of(graph.edges, [](const PoseGraph::Edge& edge) {
    return edge.information.llt().info() == Eigen::Success;
  });
  if (!all_definite) return {{}, "PCM needs covariances, and an information matrix is singular"};
  const GraphPcm kept = graph_pcm(graph, study.pcm);
  Attempt<Pose> attempt{optimize(graph, study.gnc.optimizer, kept.edge_weights), "", kept.optimal};
  attempt.solution.edge_weights = kept.edge_weights;
  return attempt;
}

template <class P>
Attempt<P> attempt_of(LoopMethod method, const BasicPoseGraph<P>& graph, const LoopStudy& study) {
  GncConfig gnc = study.gnc;
  gnc.plain = method == LoopMethod::gnc;
  Attempt<P> attempt =
      method == LoopMethod::pcm ? with_pcm(graph, study) : Attempt<P>{optimize_gnc(graph, gnc), "", true};
  if (!attempt.solution.ok()) attempt.reason = attempt.solution.reason;
  return attempt;
}

template <class P>
LoopDecision judged(const Attempt<P>& attempt, const LabelledGraph<P>& labelled,
                    const Reference<P>& reference) {
  LoopDecision decision;
  const std::vector<double>& weights = attempt.solution.edge_weights;
  for (std::size_t e = 0; e < labelled.graph.edges.size(); ++e)
    if (labelled.graph.edges[e].kind == EdgeKind::loop)
      decision.score.add(e < labelled.num_true, weights[e] >= 0.5);
  decision.parts = num_parts(labelled.graph, weights);
  decision.possible_parts = reference.parts;
  decision.off_m = largest_distance_m(attempt.solution.poses, reference.poses);
  decision.is_optimal = attempt.is_optimal;
  decision.refused = static_cast<int>(attempt.solution.refused.size());
  return decision;
}

/// All methods on one labelled graph.
template <class P>
FalseLoopRun run_methods(const LabelledGraph<P>& labelled, const Reference<P>& reference,
                         const ListedGraph& listed, const LoopStudy& study) {
  FalseLoopRun run;
  run.graph = listed.name;
  run.injection = listed.injection;
  run.num_nodes = static_cast<int>(labelled.graph.nodes.size());
  run.num_false = static_cast<int>(labelled.graph.edges.size() - labelled.num_true);
  run.num_true = static_cast<int>(num_loops(labelled.graph)) - run.num_false;
  const Phase phase(listed.name, kLoopMethods.size());
  for (std::size_t m = 0; m < kLoopMethods.size(); ++m, phase.advance()) {
    if (listed.large && kLoopMethods[m] != LoopMethod::adit) {
      run.reasons[m] = "left out, as it takes too long on a graph that is listed as large";
      continue;
    }
    const double start_s = processor_s();
    const Attempt<P> attempt = attempt_of(kLoopMethods[m], labelled.graph, study);
    const double time_s = processor_s() - start_s;
    run.reasons[m] = attempt.reason;
    if (!attempt.reason.empty()) continue;
    run.decisions[m] = judged(attempt, labelled, reference);
    run.decisions[m]->time_s = time_s;
  }
  return run;
}

void take(FalseLoopRun run, int share_pct, const LoopStudy& study) {
  run.share_pct = share_pct;
  study.on_run(std::move(run));
}

/// A graph whose loops are all true, with each share of false ones added.
template <class P>
Result<> run_injected(const ListedGraph& listed, const BasicPoseGraph<P>& graph, const LoopStudy& study) {
  const BasicPoseGraph<P> clean = with_every_nth_loop(graph, listed.keep_every);
  const Result<Reference<P>> reference = solved(clean, study.gnc.optimizer);
  if (!reference) return fail(listed.path, reference.error());
  const FalseLoops kind = listed.injection == "random" ? FalseLoops::random : FalseLoops::clustered;
  const double bound = chi2_quantile(study.gnc.inlier_probability, P::kDof);
  for (const int share : study.shares) {
    throw_if_cancelled();
    LabelledGraph<P> labelled = with_false_loops(clean, 0.01 * share, kind, listed.seed);
    drop_true_by_chance(labelled, reference->poses, bound);
    take(run_methods(labelled, *reference, listed, study), share, study);
  }
  return {};
}

double tilt_deg(const Pose& T) {
  return std::acos(std::clamp(T.rotation_matrix()(2, 2), -1.0, 1.0)) / kDegree;
}

/// A graph with false loops of its own. Its robots drove on a floor, so a loop that tilts is false.
Result<> run_as_found(const ListedGraph& listed, const PoseGraph& graph, const LoopStudy& study) {
  LabelledGraph<Pose> labelled{with_every_nth_loop(graph, listed.keep_every), 0};
  const auto first_false =
      std::stable_partition(labelled.graph.edges.begin(), labelled.graph.edges.end(), [&](const auto& edge) {
        return edge.kind == EdgeKind::odometry || tilt_deg(edge.T_from_to) <= listed.max_tilt_deg;
      });
  labelled.num_true = static_cast<std::size_t>(first_false - labelled.graph.edges.begin());
  const std::size_t num_false = labelled.graph.edges.size() - labelled.num_true;
  PoseGraph clean = labelled.graph;
  clean.edges.resize(labelled.num_true);
  const Result<Reference<Pose>> reference = solved(clean, study.gnc.optimizer);
  if (!reference) return fail(listed.path, reference.error());
  const std::size_t loops = std::max<std::size_t>(1, num_loops(labelled.graph));
  const double share = static_cast<double>(num_false) / static_cast<double>(loops);
  take(run_methods(labelled, *reference, listed, study), static_cast<int>(std::lround(100.0 * share)), study);
  return {};
}

}  // namespace

Result<> run_graph(const ListedGraph& listed, const LoopStudy& study) {
  const Result<G2oFile> file = read_listed(listed);
  if (!file) return tl::unexpected(file.error());
  if (listed.injection != "as found")
    return std::visit([&](const auto& graph) { return run_injected(listed, graph, study); }, file->graph);
  const auto* graph = std::get_if<PoseGraph>(&file->graph);
  if (graph == nullptr)
    return fail(listed.path +
                ": loops can be labelled by their tilt in 3-D graphs only, and this one is 2-D; remove it "
                "from the list");
  return run_as_found(listed, *graph, study);
}

Result<ChosenGraphs> chosen_graphs(const std::filesystem::path& list, const std::vector<ListedGraph>& graphs,
                                   const std::vector<std::string>& only) {
  for (const std::string& name : only)
    if (std::ranges::find(graphs, name, &ListedGraph::name) == graphs.end())
      return fail(
          format("{}: there is no graph '{}'; give the name of one of its [[graph]]", list.string(), name));
  ChosenGraphs chosen;
  for (const ListedGraph& graph : graphs) {
    if (!only.empty() && std::ranges::count(only, graph.name) == 0) continue;
    if (std::filesystem::exists(graph.path))
      chosen.graphs.push_back(graph);
    else
      chosen.notes.push_back(format("{} is left out: {} is absent", graph.name, graph.path));
  }
  return chosen;
}

std::string summary_line(const FalseLoopRun& run) {
  std::string line = format("{:24} {:9} {:2} % of {:4} loops false:", run.graph, run.injection, run.share_pct,
                            run.num_true + run.num_false);
  for (std::size_t m = 0; m < kLoopMethods.size(); ++m) {
    line += format("  {} ", to_string(kLoopMethods[m]));
    if (const auto& decision = run.decisions[m])
      line += format("{} false kept, {} true lost, {} refused, {:.3f} m off, {:.2f} s;",
                     decision->score.false_kept, decision->score.true_lost, decision->refused,
                     decision->off_m, decision->time_s);
    else
      line += "-;";
  }
  return line;
}

}  // namespace adit

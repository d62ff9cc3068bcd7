// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "adit/core/format.hpp"
#include "adit/evaluation/false_loop_result.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/posegraph/false_loops.hpp"
#include "adit/posegraph/gnc.hpp"
#include "adit/posegraph/graph_pcm.hpp"
#include "adit/report/text_tables.hpp"
#include "command_line.hpp"
#include "loop_graphs.hpp"
#include "page_tables.hpp"
#include "processor_time.hpp"
#include "progress.hpp"

namespace adit::app {
namespace {

constexpr const char* kSection = "false loops";

struct Options {
  std::string graphs;
  std::string data;
  std::string out;
  std::string page;
  std::vector<int> shares = {10, 30, 50, 70};
  std::vector<std::string> only;
  bool json = false;
};

struct StudyConfig {
  GncConfig gnc;
  PcmConfig pcm;
};
Fields fields_of(StudyConfig& c) {
  Fields fields;
  append(fields, "gnc", adit::fields_of(c.gnc));
  append(fields, "pcm", adit::fields_of(c.pcm));
  return fields;
}

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

/// Both hold the first node of each part where it is.
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

Attempt<Pose2> with_pcm(const PoseGraph2&, const StudyConfig&) {
  return {{}, "PCM is written for graphs in space, and this one is plane"};
}

Attempt<Pose> with_pcm(const PoseGraph& graph, const StudyConfig& config) {
  const bool all_definite = std::ranges::all_of(graph.edges, [](const PoseGraph::Edge& edge) {
    return edge.information.llt().info() == Eigen::Success;
  });
  if (!all_definite) return {{}, "PCM needs covariances, and an information matrix is singular"};
  const GraphPcm kept = graph_pcm(graph, config.pcm);
  Attempt<Pose> attempt{optimize(graph, config.gnc.optimizer, kept.edge_weights), "", kept.optimal};
  attempt.solution.edge_weights = kept.edge_weights;
  return attempt;
}

template <class P>
Attempt<P> attempt_of(LoopMethod method, const BasicPoseGraph<P>& graph, StudyConfig config) {
  config.gnc.plain = method == LoopMethod::gnc;
  Attempt<P> attempt = method == LoopMethod::pcm ? with_pcm(graph, config)
                                                 : Attempt<P>{optimize_gnc(graph, config.gnc), "", true};
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
  return decision;
}

/// All methods on one labelled graph.
template <class P>
FalseLoopRun run_methods(const LabelledGraph<P>& labelled, const Reference<P>& reference,
                         const ListedGraph& listed, const StudyConfig& config) {
  FalseLoopRun run;
  run.graph = listed.name;
  run.injection = listed.injection;
  run.num_nodes = static_cast<int>(labelled.graph.nodes.size());
  run.num_false = static_cast<int>(labelled.graph.edges.size() - labelled.num_true);
  run.num_true = static_cast<int>(num_loops(labelled.graph)) - run.num_false;
  for (std::size_t m = 0; m < kLoopMethods.size(); ++m) {
    if (listed.large && kLoopMethods[m] != LoopMethod::adit) {
      run.reasons[m] = "left out, as it takes too long on a graph that is listed as large";
      continue;
    }
    const double start_s = processor_s();
    const Attempt<P> attempt = attempt_of(kLoopMethods[m], labelled.graph, config);
    const double time_s = processor_s() - start_s;
    run.reasons[m] = attempt.reason;
    if (!attempt.reason.empty()) continue;
    run.decisions[m] = judged(attempt, labelled, reference);
    run.decisions[m]->time_s = time_s;
  }
  return run;
}

/// Goes where it does not mix with JSON.
void print_line(const FalseLoopRun& run, std::FILE* to) {
  std::string line = format("{:24} {:9} {:2} % of {:4} loops false:", run.graph, run.injection, run.share_pct,
                            run.num_true + run.num_false);
  for (std::size_t m = 0; m < kLoopMethods.size(); ++m) {
    line += format("  {} ", to_string(kLoopMethods[m]));
    if (const auto& decision = run.decisions[m])
      line += format("{} false kept, {} true lost, {:.3f} m off, {:.2f} s;", decision->score.false_kept,
                     decision->score.true_lost, decision->off_m, decision->time_s);
    else
      line += "-;";
  }
  std::fprintf(to, "%s\n", line.c_str());
  std::fflush(to);
}

void take(FalseLoopRun run, int share_pct, const Options& options, std::vector<FalseLoopRun>& runs) {
  run.share_pct = share_pct;
  print_line(run, options.json ? stderr : stdout);
  runs.push_back(std::move(run));
}

/// A graph that is true as it stands, spoiled with each share.
template <class P>
Result<> run_injected(const ListedGraph& listed, const BasicPoseGraph<P>& graph, const StudyConfig& config,
                      const Options& options, std::vector<FalseLoopRun>& runs) {
  const BasicPoseGraph<P> clean = with_every_nth_loop(graph, listed.keep_every);
  const Result<Reference<P>> reference = solved(clean, config.gnc.optimizer);
  if (!reference) return fail(listed.path, reference.error());
  const FalseLoops kind = listed.injection == "random" ? FalseLoops::random : FalseLoops::clustered;
  const double bound = chi2_quantile(config.gnc.inlier_probability, P::kDof);
  for (const int share : options.shares) {
    if (interrupted()) return fail("interrupted");
    LabelledGraph<P> labelled = with_false_loops(clean, 0.01 * share, kind, listed.seed);
    drop_true_by_chance(labelled, reference->poses, bound);
    take(run_methods(labelled, *reference, listed, config), share, options, runs);
  }
  return {};
}

double tilt_deg(const Pose& T) {
  return std::acos(std::clamp(T.rotation_matrix()(2, 2), -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

/// A graph with false loops of its own. Its robots drove on a floor, so that a loop that tilts is false.
Result<> run_as_found(const ListedGraph& listed, const PoseGraph& graph, const StudyConfig& config,
                      const Options& options, std::vector<FalseLoopRun>& runs) {
  LabelledGraph<Pose> labelled{with_every_nth_loop(graph, listed.keep_every), 0};
  const auto first_false = std::ranges::stable_partition(labelled.graph.edges, [&](const auto& edge) {
    return edge.kind == EdgeKind::odometry || tilt_deg(edge.T_from_to) <= listed.max_tilt_deg;
  });
  labelled.num_true = labelled.graph.edges.size() - first_false.size();
  PoseGraph clean = labelled.graph;
  clean.edges.resize(labelled.num_true);
  const Result<Reference<Pose>> reference = solved(clean, config.gnc.optimizer);
  if (!reference) return fail(listed.path, reference.error());
  const std::size_t loops = std::max<std::size_t>(1, num_loops(labelled.graph));
  const double share = static_cast<double>(first_false.size()) / static_cast<double>(loops);
  take(run_methods(labelled, *reference, listed, config), static_cast<int>(std::lround(100.0 * share)),
       options, runs);
  return {};
}

Result<> run_graph(const ListedGraph& listed, const StudyConfig& config, const Options& options,
                   std::vector<FalseLoopRun>& runs) {
  const Result<G2oFile> file = read_listed(listed);
  if (!file) return tl::unexpected(file.error());
  if (listed.injection != "as found")
    return std::visit([&](const auto& graph) { return run_injected(listed, graph, config, options, runs); },
                      file->graph);
  const auto* graph = std::get_if<PoseGraph>(&file->graph);
  if (graph == nullptr)
    return fail(listed.path +
                ": loops that tilt are told in graphs in space only; this one is plane, take it "
                "off the list");
  return run_as_found(listed, *graph, config, options, runs);
}

/// Those named, or else all; without the ones that are absent.
Result<std::vector<ListedGraph>> chosen_graphs(const Options& options) {
  Result<std::vector<ListedGraph>> all = read_graph_list(options.graphs, options.data);
  if (!all) return all;
  for (const std::string& name : options.only)
    if (std::ranges::find(*all, name, &ListedGraph::name) == all->end())
      return fail(format("{}: there is no graph '{}'", options.graphs, name));
  std::erase_if(*all, [&](const ListedGraph& graph) {
    return !options.only.empty() && std::ranges::count(options.only, graph.name) == 0;
  });
  std::erase_if(*all, [](const ListedGraph& graph) {
    if (std::filesystem::exists(graph.path)) return false;
    std::fprintf(stderr, "%s is left out: %s is absent\n", graph.name.c_str(), graph.path.c_str());
    return true;
  });
  return all;
}

using Json = nlohmann::ordered_json;

Json json_of(const std::optional<LoopDecision>& decision, const std::string& reason) {
  if (!decision) return {{"reason", reason}};
  return {{"true_kept", decision->score.true_kept},
          {"true_lost", decision->score.true_lost},
          {"false_kept", decision->score.false_kept},
          {"false_rejected", decision->score.false_rejected},
          {"parts", decision->parts},
          {"possible_parts", decision->possible_parts},
          {"off_m", decision->off_m},
          {"time_s", decision->time_s},
          {"optimal", decision->is_optimal}};
}

Json json_of(const FalseLoopRun& run) {
  Json json = {{"graph", run.graph},     {"injection", run.injection}, {"share_pct", run.share_pct},
               {"nodes", run.num_nodes}, {"true_loops", run.num_true}, {"false_loops", run.num_false}};
  for (std::size_t m = 0; m < kLoopMethods.size(); ++m)
    json[std::string(to_string(kLoopMethods[m]))] = json_of(run.decisions[m], run.reasons[m]);
  return json;
}

Result<> loop_study(Options options, const Common& common) {
  options.json = common.json;
  StudyConfig config;
  if (const Result<> configured = configure(fields_of(config), common); !configured) return configured;
  const Result<std::vector<ListedGraph>> graphs = chosen_graphs(options);
  if (!graphs) return tl::unexpected(graphs.error());
  std::filesystem::create_directories(options.out);
  catch_interrupts();
  std::vector<FalseLoopRun> runs;
  for (const ListedGraph& graph : *graphs)
    if (const Result<> done = run_graph(graph, config, options, runs); !done) return done;
  Json all = Json::array();
  for (const FalseLoopRun& run : runs) all.push_back(json_of(run));
  const std::string json = Json{{"version", 1}, {"runs", all}}.dump(1) + "\n";
  const std::vector<Table> tables = false_loop_tables(runs);
  Result<> done = write_bytes(std::filesystem::path(options.out) / "false_loops.json", json);
  if (done && !options.page.empty()) done = write_tables(options.page, kSection, tables);
  if (done && common.json) std::printf("%s", json.c_str());
  if (done && !common.json)
    for (const Table& table : tables) std::printf("\n%s", text_of(table).c_str());
  return done;
}

}  // namespace

void add_loop_study(Program& program) {
  const auto options = std::make_shared<Options>();
  CLI::App* command = program.add_command(
      "loop-study", "Which false loops plain GNC, PCM and adit's own search find, over a list of pose graphs",
      [options](const Common& common) { return loop_study(*options, common); });
  command->add_option("--graphs", options->graphs, "The list (TOML, as bench/merge/graphs.toml)")->required();
  command->add_option("--data", options->data,
                      "Folder where the paths of the list begin, instead of the list's own");
  command->add_option("--out", options->out, "Folder that takes the results (false_loops.json)")->required();
  command
      ->add_option("--shares", options->shares, "Per cent of all loops that are false, separated by commas")
      ->delimiter(',')
      ->check(CLI::Range(0, 99))
      ->capture_default_str();
  command->add_option("--only", options->only, "Only the graphs of these names")->delimiter(',');
  command->add_option("--page", options->page,
                      "Markdown file whose section between 'false loops' marks takes the tables");
}

}  // namespace adit::app

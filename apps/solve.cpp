// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "adit/core/format.hpp"
#include "adit/core/json_text.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/g2o.hpp"
#include "adit/io/jrl.hpp"
#include "adit/posegraph/certificate.hpp"
#include "adit/posegraph/gnc.hpp"
#include "adit/study/graph_judgement.hpp"
#include "command_line.hpp"

namespace adit::app {
namespace {

struct SolveOptions {
  std::vector<std::string> graphs;
  bool join = false;
  bool gnc = false;
  bool chordal = false;
  bool no_certificate = false;
  std::string out;
  std::string repair;
};

// A graph of either format.
struct GraphFile {
  std::variant<PoseGraph, PoseGraph2> graph;
  std::vector<std::string> edge_places;  // "line 7"; one per edge that the file has
  std::vector<std::string> notes;
  std::optional<JrlFile> jrl;
};

GraphFile graph_of(G2oFile file) {
  GraphFile out{std::move(file.graph), {}, std::move(file.notes), {}};
  for (const std::size_t line : file.edge_lines) out.edge_places.push_back(format("line {}", line));
  return out;
}

GraphFile graph_of(JrlFile file) {
  GraphFile out;
  std::visit([&](const auto& jrl) { out.graph = with_priors_as_edges(jrl); }, file.content);
  out.edge_places = std::move(file.edge_places);
  out.notes = std::move(file.notes);
  out.jrl = std::move(file);
  return out;
}

bool is_log(const std::filesystem::path& path) {
  return path.extension() == ".jrl" || path.extension() == ".cbor" || path.extension() == ".jrr";
}

Result<GraphFile> read_graph(const std::filesystem::path& path) {
  if (is_log(path)) return read_jrl(path).map([](JrlFile file) { return graph_of(std::move(file)); });
  return read_g2o(path).map([](G2oFile file) { return graph_of(std::move(file)); });
}

// One graph of several files.
Result<GraphFile> read_joined(const std::vector<std::string>& paths) {
  std::vector<G2oFile> files;
  for (const std::string& path : paths) {
    if (is_log(path)) usage_error(format("--join takes g2o files; {} holds all its robots itself", path));
    Result<G2oFile> file = read_g2o(path);
    if (!file) return tl::unexpected(file.error());
    files.push_back(std::move(*file));
  }
  return merge_g2o(files).map([&](G2oFile merged) {
    const std::vector<std::size_t> file_of = merged.edge_files;
    GraphFile out = graph_of(std::move(merged));
    for (std::size_t e = 0; e < file_of.size(); ++e)
      out.edge_places[e] = format("{}: {}", paths[file_of[e]], out.edge_places[e]);
    return out;
  });
}

template <class P>
void zero_cross_blocks(BasicPoseGraph<P>& graph, const std::vector<std::size_t>& edges) {
  constexpr int kTranslation = P::kDof == 6 ? 3 : 2;
  constexpr int kRotation = P::kDof - kTranslation;
  for (const std::size_t e : edges) {
    auto& information = graph.edges[e].information;
    information.template topRightCorner<kTranslation, kRotation>().setZero();
    information.template bottomLeftCorner<kRotation, kTranslation>().setZero();
  }
}

// Refuses indefinite information matrices, or repairs them all where --repair asks for it.
template <class P>
Result<> check_information(const std::string& name, const SolveOptions& options, BasicPoseGraph<P>& graph,
                           GraphFile& file) {
  const std::vector<std::size_t> bad = indefinite_edges(graph);
  if (bad.empty()) return {};
  const std::string found = format("{} of {} information matrices are indefinite, the first on {}",
                                   bad.size(), graph.edges.size(), file.edge_places[bad.front()]);
  if (options.repair.empty()) {
    return fail(
        format("{}: {}; --repair zero-cross-blocks zeroes the translation-rotation blocks", name, found));
  }
  // Where some are wrong, the cross blocks of the others cannot be trusted either.
  std::vector<std::size_t> all(graph.edges.size());
  for (std::size_t e = 0; e < all.size(); ++e) all[e] = e;
  zero_cross_blocks(graph, all);
  file.notes.push_back(found + "; the translation-rotation blocks of all edges were set to zero");
  if (indefinite_edges(graph).empty()) return {};
  return fail(format("{}: {}, and still are with their translation-rotation blocks zeroed", name, found));
}

Result<> replace_file(const std::filesystem::path& path, const GraphFile& file) {
  Result<AtomicFile> output = AtomicFile::create(path);
  if (!output) return tl::unexpected(output.error());
  std::visit([&](const auto& graph) { write_g2o(output->stream(), graph); }, file.graph);
  return output->commit();
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Replaces the solution by a better one where the certificate's search finds it.
template <class P>
nlohmann::json certify_solution(const BasicPoseGraph<P>& graph, const OptimizerConfig& config,
                                Solution<P>& s) {
  const auto start = std::chrono::steady_clock::now();
  Certified<P> found = certified(graph, std::move(s));
  const double seconds = seconds_since(start);
  const auto search = std::chrono::steady_clock::now();
  found = improved(graph, std::move(found), config);
  const Certificate& c = found.certificate;
  const double eigenvalue = c.smallest_eigenvalue;
  nlohmann::json out{
      {"status", std::string(to_string(c.optimality))},
      {"reason", c.reason},
      {"gap", c.gap},
      {"lower_bound", c.lower_bound},
      {"smallest_eigenvalue", std::isfinite(eigenvalue) ? nlohmann::json(eigenvalue) : nlohmann::json()},
      {"given", std::string(to_string(found.given))},
      {"descents", found.descents},
      {"time_s", seconds},
      {"search_time_s", seconds_since(search)}};
  s = std::move(found.solution);
  return out;
}

nlohmann::json error_json(const std::optional<PositionError>& error) {
  if (!error) return {};
  return {{"ate_rmse_m", error->rmse_m}, {"ate_max_m", error->max_m}};
}

nlohmann::json share_json(const std::optional<double>& share) {
  return share ? nlohmann::json(*share) : nlohmann::json();
}

nlohmann::json judgement_json(const GraphJudgement& judgement) {
  nlohmann::json robots = nlohmann::json::array();
  for (const auto& robot : judgement.robots)
    robots.push_back({{"name", robot.name}, {"poses", robot.num_poses}, {"error", error_json(robot.error)}});
  nlohmann::json maps = nlohmann::json::array();
  for (const auto& map : judgement.maps)
    maps.push_back({{"robots", map.robots}, {"error", error_json(map.error)}});
  nlohmann::json out{{"robots", robots}, {"maps", maps}, {"loops", nlohmann::json()}};
  if (const auto& loops = judgement.loops)
    out["loops"] = {{"precision", share_json(loops->precision())},
                    {"recall", share_json(loops->recall())},
                    {"true_kept", loops->true_kept},
                    {"true_lost", loops->true_lost},
                    {"false_kept", loops->false_kept},
                    {"false_rejected", loops->false_rejected}};
  return out;
}

// Takes the priors out of the solution, and compares it with what the file knows of the truth.
template <class P>
GraphJudgement judge(const JrlFile& file, BasicPoseGraph<P>& graph, Solution<P>& s) {
  const auto& jrl = std::get<JrlGraph<P>>(file.content);
  s.poses = in_frame_of_priors(jrl, std::move(s.poses));
  s.edge_weights.resize(jrl.graph.edges.size());
  graph = jrl.graph;
  return judged(jrl, file.robots, s);
}

template <class P>
Result<nlohmann::json> solve(const std::string& name, const SolveOptions& options, const GncConfig& config,
                             BasicPoseGraph<P>& graph, GraphFile& file) {
  if (const Result<> sound = check_information(name, options, graph, file); !sound) {
    return tl::unexpected(sound.error());
  }
  const auto start = std::chrono::steady_clock::now();
  Solution<P> s = options.gnc ? optimize_gnc(graph, config) : optimize(graph, config.optimizer);
  const double seconds = seconds_since(start);
  if (!s.ok()) return fail(format("{}: {}: {}", name, to_string(s.status), s.reason));
  const double found = s.cost_final;
  nlohmann::json certificate;
  if (!options.no_certificate) certificate = certify_solution(graph, config.optimizer, s);
  std::optional<GraphJudgement> judgement;
  if (file.jrl) judgement = judge(*file.jrl, graph, s);
  for (std::size_t i = 0; i < s.poses.size(); ++i) graph.nodes[i].pose = s.poses[i];
  file.notes.insert(file.notes.end(), s.notes.begin(), s.notes.end());
  if (s.cost_final < found) {
    file.notes.push_back(format(
        "the first minimum, of cost {:.6f}, was not optimal; the certificate led to a lower one", found));
  }
  const auto rejected = std::ranges::count_if(s.edge_weights, [](double w) { return w < 0.5; });
  nlohmann::json result{{"file", name},
                        {"cost_initial", s.cost_initial},
                        {"cost_final", s.cost_final},
                        {"iterations", s.iterations},
                        {"time_s", seconds},
                        {"status", std::string(to_string(s.status))},
                        {"loops_rejected", rejected},
                        {"notes", file.notes}};
  if (!options.no_certificate) result["certificate"] = std::move(certificate);
  if (judgement) {
    result["judgement"] = judgement_json(*judgement);
    result["judgement"]["sentences"] = sentences(*judgement);
  }
  return result;
}

// ", globally optimal (gap 0.0012 %)", or what else is known.
std::string verdict(const nlohmann::json& r) {
  if (!r.contains("certificate")) return {};
  const nlohmann::json& c = r["certificate"];
  const std::string gap = format("{:.2g} %", 100.0 * c["gap"].get<double>());
  if (c["status"] == to_string(Optimality::globally_optimal))
    return format(", globally optimal (gap {})", gap);
  return format(", cannot tell whether globally optimal (gap at most {})", gap);
}

void print_line(const nlohmann::json& r, bool gnc) {
  const std::string loops =
      gnc ? format(", {} loops rejected", r["loops_rejected"].get<int>()) : std::string();
  std::puts(format("{}: cost {:.6f} -> {:.6f}, {} iterations, {:.3f} s, {}{}{}", r["file"].get<std::string>(),
                   r["cost_initial"].get<double>(), r["cost_final"].get<double>(), r["iterations"].get<int>(),
                   r["time_s"].get<double>(), r["status"].get<std::string>(), loops, verdict(r))
                .c_str());
  if (r.contains("judgement"))
    for (const auto& line : r["judgement"]["sentences"])
      std::puts(format("  {}", line.get<std::string>()).c_str());
  for (const auto& note : r["notes"]) std::fprintf(stderr, "  note: %s\n", note.get<std::string>().c_str());
}

Result<> run(const SolveOptions& options, const Common& common) {
  if (!options.out.empty() && options.graphs.size() != 1 && !options.join)
    usage_error("--out takes the result of one graph only; files that are parts of one need --join");
  const Result<RunConfig> run_config = configured(common);
  if (!run_config) return tl::unexpected(run_config.error());
  GncConfig config = run_config->slam.back_end.gnc;
  if (options.chordal) config.optimizer.initialization = SolveStart::chordal;
  nlohmann::json all = nlohmann::json::array();
  const bool joined = options.join && options.graphs.size() > 1;
  for (std::size_t g = 0; g < (joined ? 1 : options.graphs.size()); ++g) {
    const std::string name = joined
                                 ? format("{} and {} more", options.graphs.front(), options.graphs.size() - 1)
                                 : options.graphs[g];
    Result<GraphFile> file = joined ? read_joined(options.graphs) : read_graph(name);
    if (!file) return tl::unexpected(file.error());
    const auto result =
        std::visit([&](auto& graph) { return solve(name, options, config, graph, *file); }, file->graph);
    if (!result) return tl::unexpected(result.error());
    if (!options.out.empty()) {
      if (const Result<> written = replace_file(options.out, *file); !written) return written;
    }
    if (!common.json) print_line(*result, options.gnc);
    all.push_back(*result);
  }
  if (common.json) std::puts(json_text(all.size() == 1 ? all.front() : all, 2).c_str());
  return {};
}

}  // namespace

void add_solve(Program& program) {
  auto options = std::make_shared<SolveOptions>();
  const Command command = program.add_command(
      "solve", "Optimize 2-D or 3-D pose graphs, g2o or JRL files (fields back_end.gnc.*)",
      [options](const Common& common) { return run(*options, common); });
  command
      .add_option("GRAPH", options->graphs, "g2o files, or JSON Robot Logs (.jrl, .cbor) of several robots")
      .required();
  command.add_flag(
      "--join", options->join,
      "The g2o files are parts of one graph, as one for each robot: nodes of equal keys are one, and "
      "edges that two files repeat count once");
  command.add_flag("--gnc", options->gnc, "Find and reject false loops (graduated non-convexity)");
  command.add_flag("--chordal", options->chordal, "Start from chordal relaxation whatever the file's poses");
  command.add_flag("--no-certificate", options->no_certificate,
                   "Do not test whether the solution is globally optimal, nor search for a better one");
  command.add_option("--out", options->out, "Write the optimized graph here (g2o)");
  command.add_option("--repair", options->repair, "Repair indefinite information matrices")
      .one_of({"zero-cross-blocks"});
}

}  // namespace adit::app

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/g2o.hpp"
#include "adit/posegraph/gnc.hpp"
#include "command_line.hpp"

namespace adit::app {
namespace {

struct SolveOptions {
  std::vector<std::string> graphs;
  bool gnc = false;
  bool chordal = false;
  std::string out;
  std::string repair;
};

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
                           G2oFile& file) {
  const std::vector<std::size_t> bad = indefinite_edges(graph);
  if (bad.empty()) return {};
  const std::string found = format("{} of {} information matrices are indefinite, the first on line {}",
                                   bad.size(), graph.edges.size(), file.edge_lines[bad.front()]);
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

Result<> replace_file(const std::filesystem::path& path, const G2oFile& file) {
  Result<AtomicFile> output = AtomicFile::create(path);
  if (!output) return tl::unexpected(output.error());
  std::visit([&](const auto& graph) { write_g2o(output->stream(), graph); }, file.graph);
  return output->commit();
}

template <class P>
Result<nlohmann::json> solve(const std::string& name, const SolveOptions& options, const GncConfig& config,
                             BasicPoseGraph<P>& graph, G2oFile& file) {
  if (const Result<> sound = check_information(name, options, graph, file); !sound) {
    return tl::unexpected(sound.error());
  }
  const auto start = std::chrono::steady_clock::now();
  const Solution<P> s = options.gnc ? optimize_gnc(graph, config) : optimize(graph, config.optimizer);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!s.ok()) return fail(format("{}: {}: {}", name, to_string(s.status), s.reason));
  for (std::size_t i = 0; i < s.poses.size(); ++i) graph.nodes[i].pose = s.poses[i];
  file.notes.insert(file.notes.end(), s.notes.begin(), s.notes.end());
  const auto rejected = std::ranges::count_if(s.edge_weights, [](double w) { return w < 0.5; });
  return nlohmann::json{{"file", name},
                        {"cost_initial", s.cost_initial},
                        {"cost_final", s.cost_final},
                        {"iterations", s.iterations},
                        {"time_s", seconds},
                        {"status", std::string(to_string(s.status))},
                        {"loops_rejected", rejected},
                        {"notes", file.notes}};
}

void print_line(const nlohmann::json& r, bool gnc) {
  const std::string loops =
      gnc ? format(", {} loops rejected", r["loops_rejected"].get<int>()) : std::string();
  std::puts(format("{}: cost {:.6f} -> {:.6f}, {} iterations, {:.3f} s, {}{}", r["file"].get<std::string>(),
                   r["cost_initial"].get<double>(), r["cost_final"].get<double>(), r["iterations"].get<int>(),
                   r["time_s"].get<double>(), r["status"].get<std::string>(), loops)
                .c_str());
  for (const auto& note : r["notes"]) std::fprintf(stderr, "  note: %s\n", note.get<std::string>().c_str());
}

Result<> run(const SolveOptions& options, const Common& common) {
  if (!options.out.empty() && options.graphs.size() != 1)
    usage_error("--out takes the result of one graph only");
  const Result<RunConfig> run_config = configured(common);
  if (!run_config) return tl::unexpected(run_config.error());
  GncConfig config = run_config->slam.back_end.gnc;
  if (options.chordal) config.optimizer.initialization = SolveStart::chordal;
  nlohmann::json all = nlohmann::json::array();
  for (const std::string& name : options.graphs) {
    Result<G2oFile> file = read_g2o(std::filesystem::path(name));
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
  if (common.json) std::puts((all.size() == 1 ? all.front() : all).dump(2).c_str());
  return {};
}

}  // namespace

void add_solve(Program& program) {
  auto options = std::make_shared<SolveOptions>();
  const Command command =
      program.add_command("solve", "Optimize 2-D or 3-D pose graphs in g2o files (fields back_end.gnc.*)",
                          [options](const Common& common) { return run(*options, common); });
  command.add_option("GRAPH", options->graphs, "g2o files").required();
  command.add_flag("--gnc", options->gnc, "Find and reject false loops (graduated non-convexity)");
  command.add_flag("--chordal", options->chordal, "Start from chordal relaxation whatever the file's poses");
  command.add_option("--out", options->out, "Write the optimized graph here");
  command.add_option("--repair", options->repair, "Repair indefinite information matrices")
      .one_of({"zero-cross-blocks"});
}

}  // namespace adit::app

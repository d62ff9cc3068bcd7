// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/study.hpp"

#include <sys/resource.h>
#include <chrono>
#include <cstdio>
#include <memory>

#include "adit/io/atomic_file.hpp"
#include "adit/io/config_toml.hpp"
#include "adit/io/world_files.hpp"
#include "adit/report/metrics_json.hpp"
#include "adit/report/text_tables.hpp"
#include "command_line.hpp"
#include "policies.hpp"

namespace adit::app {
namespace {

struct StudyOptions {
  bool quick = false;
  std::string world;
  std::string routes;
  std::string out;
  SimulationOptions simulation;
  std::vector<std::string> keyframes = {"all", "tunnel_filter", "tunnel_filter_keep", "adaptive"};
};

double peak_rss_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

Result<World> world_of(const StudyOptions& options, const WorldConfig& built_in) {
  if (options.routes.empty() && options.world.empty()) return make_world(built_in);
  if (options.routes.empty()) usage_error("--world needs --routes FILE, the routes of the robots in it");
  return load_world(options.world, options.routes);
}

Provenance provenance_of(const StudyOptions& options, const Common& common, RunConfig config,
                         const World& world) {
  Provenance provenance;
  provenance.command = common.command;
  if (!options.routes.empty()) provenance.inputs = {options.routes};
  provenance.world = options.world.empty() ? world.name : options.world;
  provenance.profile = to_string(common.profile);
  provenance.settings = common.sets;
  provenance.seed = config.simulation.seed;
  provenance.configuration = to_toml(fields_of(config));
  return provenance;
}

void print(const StudyResult& result, const std::vector<Table>& tables, const StudyOptions& options) {
  for (const Table& table : tables) std::printf("%s\n", text_of(table).c_str());
  std::printf("%.0f s, %.0f MB at most; report: %s\n", result.wall_s, result.peak_rss_mb,
              (std::filesystem::path(options.out) / "report.html").c_str());
}

Result<> study(StudyOptions options, const Common& common) {
  if (options.quick) {
    if (options.simulation.lidar.empty()) options.simulation.lidar = "vlp-16";
    options.keyframes = {std::string(to_string(KeyframeSelection::adaptive))};
  }
  const auto start = std::chrono::steady_clock::now();
  const Result<RunConfig> config = configured(common, options.simulation);
  if (!config) return tl::unexpected(config.error());
  const std::vector<KeyframeSelection> policies = policies_of(options.keyframes);
  const Result<World> world = world_of(options, config->world);
  if (!world) return tl::unexpected(world.error());
  Result<OutputDir> out = OutputDir::create(options.out, "study");
  if (!out) return tl::unexpected(out.error());
  Result<StudyResult> result =
      run_study({*config, policies, provenance_of(options, common, *config, *world), out->path()}, *world);
  if (!result) return tl::unexpected(result.error());
  result->wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result->peak_rss_mb = peak_rss_mb();
  const std::vector<Table> tables = tables_of(*result);
  Result<> done = write_study_report(*result, tables, out->path());
  if (done) done = out->commit();
  if (!done) return done;
  if (common.json)
    std::printf("%s\n", metrics_json(*result).c_str());
  else
    print(*result, tables, options);
  return {};
}

}  // namespace

void add_study(Program& program) {
  const auto options = std::make_shared<StudyOptions>();
  const Command command =
      program.add_command("study", "Run the paper's whole experiment on one world",
                          [options](const Common& common) { return study(*options, common); });
  command.add_option(
      "--world", options->world,
      "Mesh (PLY, OBJ, STL, DAE, GLB); default: the generated world of the configuration, zab");
  command.add_option("--routes", options->routes, "routes.yaml of that world");
  command.add_option("--out", options->out, "Directory to write").required();
  command.add_flag(
      "--quick", options->quick,
      "To see that all works: the policy adaptive alone, and vlp-16 unless --lidar names another");
  add_simulation_options(command, options->simulation);
  command
      .add_option("--keyframes", options->keyframes,
                  "Keyframe policies, separated by commas; all but adaptive run on `paper_odometry`")
      .separated_by_commas()
      .one_of(policy_names())
      .default_shown();
}

}  // namespace adit::app

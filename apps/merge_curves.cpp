// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/merge_curves.hpp"

#include <cstdio>
#include <memory>

#include "adit/io/atomic_file.hpp"
#include "adit/io/folders.hpp"
#include "adit/report/text_tables.hpp"
#include "adit/study/page_tables.hpp"
#include "command_line.hpp"
#include "listed_worlds.hpp"

namespace adit::app {
namespace {

constexpr const char* kCurvesSection = "merge-curves";

struct CurvesOptions {
  ListedWorldsOptions worlds{.list = {}, .choice = {{}, {"zab-1", "mine-1"}}};
  std::string effects;
  std::string out;
  std::string page;
  SimulationOptions simulation{.lidar = "os2-32", .conditions = "ideal"};
};

Result<> write(const CurvesOptions& options, const std::vector<MergeEffect>& effects,
               const std::vector<CurvePoint>& points) {
  const std::vector<Table> tables = curve_tables(effects, points);
  Result<> done =
      write_bytes(std::filesystem::path(options.out) / "curves.svg", curves_plot(effects, points));
  if (done && !options.page.empty()) done = write_tables(options.page, kCurvesSection, tables);
  for (const Table& table : tables)
    if (done) std::printf("%s\n", text_of(table).c_str());
  return done;
}

Result<> merge_curves(const CurvesOptions& options, const Common& common) {
  const Result<RunConfig> config = configured(common, options.simulation);
  if (!config) return tl::unexpected(config.error());
  const Result<std::vector<MergeEffect>> effects = read_effects(options.effects);
  if (!effects) return tl::unexpected(effects.error());
  const Result<ListedWorlds> worlds = listed_worlds(options.worlds, "merge-curves");
  if (!worlds) return tl::unexpected(worlds.error());
  if (const Result<> made = make_folder(options.out); !made) return made;
  Result<std::vector<MergeRun>> runs = read_merge_runs(std::filesystem::path(options.out) / "results.json");
  if (!runs) return tl::unexpected(runs.error());
  const auto print_line = [](const MergeRun& run) {
    std::fprintf(stderr, "%s\n", summary_line(run).c_str());
  };
  const MergeStudy study{*config, {}, "", options.out, print_line};
  return measure_curves(study, worlds->chosen, *effects, *runs).and_then([&](const auto& points) {
    return write(options, *effects, points);
  });
}

}  // namespace

void add_merge_curves(Program& program) {
  const auto options = std::make_shared<CurvesOptions>();
  const Command command = program.add_command(
      "merge-curves",
      "Measure how much of each error of sensors and places merging bears, over a list of effects",
      [options](const Common& common) { return merge_curves(*options, common); });
  add_listed_worlds_options(command, options->worlds).required();
  command.add_option("--effects", options->effects, "The effects (TOML, as bench/merge/effects.toml)")
      .required();
  command
      .add_option("--out", options->out,
                  "Folder that keeps the results of all runs, which are not run again, and takes curves.svg")
      .required();
  add_simulation_options(command, options->simulation);
  command.add_option("--page", options->page,
                     "Markdown file whose section between 'merge-curves' marks takes the tables");
}

}  // namespace adit::app

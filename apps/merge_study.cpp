// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/merge_study.hpp"

#include <cstdio>
#include <memory>

#include "adit/io/atomic_file.hpp"
#include "adit/io/folders.hpp"
#include "adit/report/text_tables.hpp"
#include "adit/study/page_tables.hpp"
#include "command_line.hpp"
#include "listed_worlds.hpp"
#include "policies.hpp"

namespace adit::app {
namespace {

constexpr const char* kMergeStudySection = "merging";

struct MergeStudyOptions {
  ListedWorldsOptions worlds;
  std::string out;
  std::string page;
  SimulationOptions simulation{.lidar = "os2-32", .conditions = "field"};
  std::vector<std::string> keyframes = {"all", "tunnel_filter", "adaptive"};
  std::string variant;
};

Result<> print(const std::filesystem::path& results, const std::vector<Table>& tables, bool json) {
  if (!json) {
    std::printf("\n");
    for (const Table& table : tables) std::printf("%s\n", text_of(table).c_str());
    return {};
  }
  return read_bytes(results).map([](const std::string& text) { std::printf("%s", text.c_str()); });
}

/// The study under the options. It prints one line of text per run, to stderr if JSON goes to stdout.
Result<MergeStudy> study_of(const MergeStudyOptions& options, const Common& common) {
  const Result<RunConfig> config = configured(common, options.simulation);
  if (!config) return tl::unexpected(config.error());
  std::FILE* lines = common.json ? stderr : stdout;
  const auto print_line = [lines](const MergeRun& run) {
    std::fprintf(lines, "%s\n", summary_line(run).c_str());
    std::fflush(lines);
  };
  return MergeStudy{*config, policies_of(options.keyframes), options.variant, options.out, print_line};
}

Result<> merge_study(const MergeStudyOptions& options, const Common& common) {
  const Result<MergeStudy> study = study_of(options, common);
  if (!study) return tl::unexpected(study.error());
  const Result<ListedWorlds> worlds = listed_worlds(options.worlds, "merge-study");
  if (!worlds) return tl::unexpected(worlds.error());
  if (const Result<> made = make_folder(study->folder / "maps"); !made) return made;
  const std::filesystem::path results = study->folder / "results.json";
  Result<std::vector<MergeRun>> runs = read_merge_runs(results);
  if (!runs) return tl::unexpected(runs.error());
  for (const ListedWorld& world : worlds->chosen)
    if (const Result<> done = run_world(*study, world, *runs); !done) return done;
  sort_by_list(*runs, worlds->all);
  const std::vector<Table> tables = merge_tables(*runs);
  Result<> done = write_merge_runs(results, *runs);
  if (done) done = write_merge_csv(study->folder / "results.csv", *runs);
  if (done && !options.page.empty()) done = write_tables(options.page, kMergeStudySection, tables);
  if (done) done = print(results, tables, common.json);
  return done;
}

}  // namespace

void add_merge_study(Program& program) {
  const auto options = std::make_shared<MergeStudyOptions>();
  const Command command = program.add_command(
      "merge-study",
      "Measure which robots' maps are merged, refused or merged wrongly, over a list of worlds",
      [options](const Common& common) { return merge_study(*options, common); });
  add_listed_worlds_options(command, options->worlds).required();
  command.add_option("--out", options->out, "Folder that keeps the robots' maps and the results of all runs")
      .required();
  command
      .add_option("--keyframes", options->keyframes,
                  "Keyframe policies, separated by commas; all but adaptive run on `paper_odometry`")
      .separated_by_commas()
      .one_of(policy_names())
      .default_shown();
  command.add_option("--variant", options->variant,
                     "Added to the policies' names, so that a run with other settings (--set) stands beside "
                     "the usual one instead of replacing it");
  add_simulation_options(command, options->simulation);
  command.add_option("--page", options->page,
                     "Markdown file whose section between 'merging' marks takes the tables of all runs");
}

}  // namespace adit::app

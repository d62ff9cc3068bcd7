// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/merge_calibration.hpp"

#include <cstdio>
#include <memory>

#include "adit/io/atomic_file.hpp"
#include "adit/io/folders.hpp"
#include "adit/report/text_tables.hpp"
#include "adit/study/evidence_fit.hpp"
#include "adit/study/merge_study.hpp"
#include "adit/study/page_tables.hpp"
#include "command_line.hpp"
#include "listed_worlds.hpp"

namespace adit::app {
namespace {

constexpr const char* kCalibrationSection = "merge-calibration";
constexpr const char* kPartName = "calibration.part.json";

struct CalibrationOptions {
  ListedWorldsOptions worlds;
  std::string out;
  std::string page;
  SimulationOptions simulation{.lidar = "os2-32", .conditions = "field"};
  std::vector<int> partners = {1};
};

Result<> add(std::vector<JudgedHypothesis>& all, const Result<std::vector<JudgedHypothesis>>& more) {
  return more.map(
      [&](const std::vector<JudgedHypothesis>& found) { all.insert(all.end(), found.begin(), found.end()); });
}

/// Each world by itself, and with those that follow it in the list, which begins anew at its end. After each,
/// calibration.part.json has all so far: a run takes hours.
Result<std::vector<JudgedHypothesis>> measure(const CalibrationStudy& study,
                                              const std::vector<ListedWorld>& worlds, int num_partners) {
  std::vector<JudgedHypothesis> all;
  for (std::size_t w = 0; w < worlds.size(); ++w) {
    Result<> done = add(all, hypotheses_within(study, worlds[w]));
    for (std::size_t k = 1; done && k <= static_cast<std::size_t>(num_partners) && k < worlds.size(); ++k)
      done = add(all, hypotheses_between(study, worlds[w], worlds[(w + k) % worlds.size()]));
    if (done) done = write_bytes(study.folder / kPartName, calibration_json(all));
    if (!done) return tl::unexpected(done.error());
  }
  return all;
}

Result<> merge_calibration(const CalibrationOptions& options, const Common& common) {
  const Result<RunConfig> config = configured(common, options.simulation);
  if (!config) return tl::unexpected(config.error());
  const Result<ListedWorlds> worlds = listed_worlds(options.worlds, "merge-calibration");
  if (!worlds) return tl::unexpected(worlds.error());
  const std::filesystem::path folder = options.out;
  if (const Result<> made = make_folder(folder / "maps"); !made) return made;
  const Result<std::vector<JudgedHypothesis>> all =
      measure({*config, folder}, worlds->chosen, options.partners.front());
  if (!all) return tl::unexpected(all.error());
  const EvidenceModel& model = config->slam.loops.adaptive.merge_check.evidence;
  std::vector<Table> tables = calibration_tables(*all);
  tables.push_back(evidence_table(model, fitted_values(*all, model)));
  const std::string json = calibration_json(*all);
  Result<> done = write_bytes(folder / "calibration.json", json);
  if (done && !options.page.empty()) done = write_tables(options.page, kCalibrationSection, tables);
  if (!done) return done;
  std::error_code ignored;
  std::filesystem::remove(folder / kPartName, ignored);
  if (common.json) std::printf("%s", json.c_str());
  for (const Table& table : tables)
    if (!common.json) std::printf("%s\n", text_of(table).c_str());
  return {};
}

}  // namespace

void add_merge_calibration(Program& program) {
  const auto options = std::make_shared<CalibrationOptions>();
  const Command command =
      program.add_command("merge-calibration",
                          "Measure whether merge checks are wrong as rarely as they state, and fit the "
                          "evidence model, over a list of worlds",
                          [options](const Common& common) { return merge_calibration(*options, common); });
  add_listed_worlds_options(command, options->worlds);
  command.add_option("--out", options->out, "Folder that keeps the robots' maps and takes calibration.json")
      .required();
  command
      .add_option("--partners", options->partners,
                  "Other worlds with whose robots those of each world are compared, for false hypotheses")
      .in_range(0, 100)
      .default_shown();
  add_simulation_options(command, options->simulation);
  command.add_option("--page", options->page,
                     "Markdown file whose section between 'merge-calibration' marks takes the tables");
}

}  // namespace adit::app

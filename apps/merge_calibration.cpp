// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/merge_calibration.hpp"

#include <cmath>
#include <cstdio>
#include <memory>

#include "adit/core/format.hpp"
#include "adit/fleet/merge/evidence_model.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/folders.hpp"
#include "adit/report/text_tables.hpp"
#include "adit/study/evidence_fit.hpp"
#include "adit/study/merge_study.hpp"
#include "adit/study/page_tables.hpp"
#include "command_line.hpp"
#include "listed_worlds.hpp"
#include "outputs.hpp"

namespace adit::app {
namespace {

constexpr const char* kCalibrationSection = "merge-calibration";
constexpr const char* kCalibrationName = "calibration.json";
constexpr const char* kPartName = "calibration.part.json";
constexpr const char* kFigureName = "merge_calibration.svg";

struct CalibrationOptions {
  ListedWorldsOptions worlds;
  std::vector<std::string> join;
  std::string out;
  std::string page;
  SimulationOptions simulation{.lidar = "os2-32", .conditions = "field"};
  std::vector<int> partners = {1};
};

Result<> add(std::vector<JudgedHypothesis>& all, const Result<std::vector<JudgedHypothesis>>& more) {
  return more.map(
      [&](const std::vector<JudgedHypothesis>& found) { all.insert(all.end(), found.begin(), found.end()); });
}

/// Of a list that begins anew at its end: two worlds may follow one another both ways round, and count once.
bool counts_pair_here(std::size_t world, std::size_t steps_on, std::size_t num_worlds) {
  return 2 * steps_on < num_worlds || (2 * steps_on == num_worlds && world < steps_on);
}

/// Each world by itself, and with those that follow it in the list, which begins anew at its end. After each,
/// calibration.part.json has all so far: a run takes hours.
Result<std::vector<JudgedHypothesis>> measure(const CalibrationStudy& study,
                                              const std::vector<ListedWorld>& worlds, int num_partners) {
  std::vector<JudgedHypothesis> all;
  for (std::size_t w = 0; w < worlds.size(); ++w) {
    Result<> done = add(all, hypotheses_within(study, worlds[w]));
    for (std::size_t k = 1; done && k <= static_cast<std::size_t>(num_partners); ++k)
      if (counts_pair_here(w, k, worlds.size()))
        done = add(all, hypotheses_between(study, worlds[w], worlds[(w + k) % worlds.size()]));
    if (done) done = write_bytes(study.folder / kPartName, calibration_json(all));
    if (!done) return tl::unexpected(done.error());
  }
  return all;
}

Result<std::vector<JudgedHypothesis>> measured_worlds(const CalibrationOptions& options,
                                                      const RunConfig& config) {
  if (options.worlds.list.empty())
    usage_error("--worlds is required: the list of worlds; or --join, what runs over parts of it wrote");
  const Result<ListedWorlds> worlds = listed_worlds(options.worlds, "merge-calibration");
  if (!worlds) return tl::unexpected(worlds.error());
  const std::filesystem::path folder = options.out;
  if (const Result<> made = make_folder(folder / "maps"); !made) return tl::unexpected(made.error());
  return measure({config, folder}, worlds->chosen, options.partners.front());
}

/// The tables say what was in use by the configuration of this command. Of that of the runs, their files tell
/// the error rate alone.
Result<> check_error_rate(const std::vector<JudgedHypothesis>& all, const EvidenceModel& in_use) {
  constexpr double kRounding = 1e-6;
  if (all.empty() || std::abs(all.front().needed + std::log(in_use.error_rate)) < kRounding) return {};
  return fail(format(
      "--join: the runs had loops.adaptive.merge_check.evidence.error_rate at {:.4g}, this command has "
      "{:.4g}; give their --profile, --config and --set",
      std::exp(-all.front().needed), in_use.error_rate));
}

Result<std::vector<JudgedHypothesis>> joined_runs(const CalibrationOptions& options,
                                                  const EvidenceModel& in_use) {
  const std::filesystem::path out = std::filesystem::path(options.out) / kCalibrationName;
  for (const std::string& file : options.join) refuse_to_replace_input(file, out.string());
  Result<std::vector<JudgedHypothesis>> all = joined_calibrations(options.join);
  if (!all) return all;
  if (const Result<> checked = check_error_rate(*all, in_use); !checked)
    return tl::unexpected(checked.error());
  if (const Result<> made = make_folder(options.out); !made) return tl::unexpected(made.error());
  return all;
}

Result<> write_calibration(const CalibrationOptions& options, const Common& common,
                           const EvidenceModel& model, const std::vector<JudgedHypothesis>& all) {
  std::vector<Table> tables = calibration_tables(all);
  tables.push_back(evidence_table(model, fitted_values(all, model)));
  const std::string json = calibration_json(all);
  const PageFigure figure{kFigureName, "Claimed and observed wrong acceptance", calibration_plot(all)};
  const std::filesystem::path folder = options.out;
  Result<> done = write_bytes(folder / kCalibrationName, json);
  if (done) done = write_bytes(folder / kFigureName, figure.svg);
  if (done && !options.page.empty()) done = write_tables(options.page, kCalibrationSection, tables, {figure});
  if (!done) return done;
  if (common.json) std::printf("%s", json.c_str());
  for (const Table& table : tables)
    if (!common.json) std::printf("%s\n", text_of(table).c_str());
  return {};
}

Result<> merge_calibration(const CalibrationOptions& options, const Common& common) {
  const Result<RunConfig> config = configured(common, options.simulation);
  if (!config) return tl::unexpected(config.error());
  const EvidenceModel& in_use = config->slam.loops.adaptive.merge_check.evidence;
  const bool joins = !options.join.empty();
  const Result<std::vector<JudgedHypothesis>> all =
      joins ? joined_runs(options, in_use) : measured_worlds(options, *config);
  if (!all) return tl::unexpected(all.error());
  const Result<> done = write_calibration(options, common, in_use, *all);
  std::error_code ignored;
  if (done && !joins) std::filesystem::remove(std::filesystem::path(options.out) / kPartName, ignored);
  return done;
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
  command.add_option("--join", options->join,
                     "Instead of --worlds: calibration.json of runs over different worlds, which count as "
                     "one; nothing is driven, and --profile, --config and --set are those of the runs");
  command
      .add_option("--out", options->out,
                  "Folder that keeps the robots' maps and takes calibration.json and merge_calibration.svg")
      .required();
  command
      .add_option("--partners", options->partners,
                  "Other worlds with whose robots those of each world are compared, for false hypotheses")
      .in_range(0, 100)
      .default_shown();
  add_simulation_options(command, options->simulation);
  command.exclude("--join",
                  {"--worlds", "--groups", "--only", "--partners", "--lidar", "--conditions"});  // not read
  command.add_option("--page", options->page,
                     "Markdown file whose section between 'merge-calibration' marks takes the tables; the "
                     "figure goes into figures/ beside it");
}

}  // namespace adit::app

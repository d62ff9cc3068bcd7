// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/uncertainty_study.hpp"

#include <cstdio>
#include <memory>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/folders.hpp"
#include "adit/report/text_tables.hpp"
#include "adit/study/merge_study.hpp"
#include "adit/study/page_tables.hpp"
#include "command_line.hpp"
#include "listed_worlds.hpp"

namespace adit::app {
namespace {

constexpr const char* kUncertaintySection = "uncertainty";

struct UncertaintyOptions {
  ListedWorldsOptions worlds;
  std::string out;
  std::vector<std::string> lidars = {"os2-32"};
  std::vector<std::string> imus = {"icm-20948"};
  std::string conditions = "field";
  std::string page;
};

Result<MeasuredUncertainty> measure(const std::filesystem::path& folder, const Result<RunConfig>& config,
                                    const std::string& sensors, const std::vector<ListedWorld>& worlds) {
  if (!config) return tl::unexpected(config.error());
  MeasuredUncertainty measured{sensors, {}};
  for (const ListedWorld& world : worlds) {
    const Result<std::vector<UncertaintyRow>> rows = measure_world({*config, folder}, world);
    if (!rows) return tl::unexpected(rows.error());
    join(measured.rows, *rows);
  }
  return measured;
}

Result<std::vector<MeasuredUncertainty>> measure_all(const UncertaintyOptions& options, const Common& common,
                                                     const std::vector<ListedWorld>& worlds) {
  std::vector<MeasuredUncertainty> all;
  for (const std::string& lidar : options.lidars) {
    for (const std::string& imu : options.imus) {
      const std::string sensors =
          format("{}, {}, {}", lidar, imu == "none" ? "no IMU" : "IMU " + imu, options.conditions);
      const Result<MeasuredUncertainty> measured =
          measure(options.out, configured(common, {lidar, imu, options.conditions}), sensors, worlds);
      if (!measured) return tl::unexpected(measured.error());
      all.push_back(*measured);
    }
  }
  return all;
}

Result<> write(const UncertaintyOptions& options, const Common& common,
               const std::vector<MeasuredUncertainty>& all) {
  std::vector<Table> tables;
  std::vector<UncertaintyRow> together;
  for (const MeasuredUncertainty& measured : all) {
    tables.push_back(uncertainty_table(measured));
    join(together, measured.rows);
  }
  const std::string json = uncertainty_json(all);
  const std::filesystem::path folder = options.out;
  Result<> done = write_bytes(folder / "uncertainty.json", json);
  if (done) done = write_bytes(folder / "uncertainty.svg", uncertainty_plot(together));
  if (done && !options.page.empty()) done = write_tables(options.page, kUncertaintySection, tables);
  if (!done) return done;
  if (common.json) std::printf("%s", json.c_str());
  for (const Table& table : tables)
    if (!common.json) std::printf("%s\n", text_of(table).c_str());
  return {};
}

Result<> uncertainty_study(const UncertaintyOptions& options, const Common& common) {
  const Result<ListedWorlds> worlds = listed_worlds(options.worlds, "uncertainty-study");
  if (!worlds) return tl::unexpected(worlds.error());
  if (const Result<> made = make_folder(std::filesystem::path(options.out) / "maps"); !made) return made;
  return measure_all(options, common, worlds->chosen).and_then([&](const auto& all) {
    return write(options, common, all);
  });
}

}  // namespace

void add_uncertainty_study(Program& program) {
  const auto options = std::make_shared<UncertaintyOptions>();
  const Command command =
      program.add_command("uncertainty-study",
                          "Measure whether stated covariances are those of the errors, over a list of worlds",
                          [options](const Common& common) { return uncertainty_study(*options, common); });
  add_listed_worlds_options(command, options->worlds).required();
  command
      .add_option("--out", options->out,
                  "Folder that keeps the robots' maps and takes uncertainty.json and .svg")
      .required();
  command.add_option("--lidar", options->lidars, "Simulated LiDARs, each with each of --imu")
      .separated_by_commas()
      .default_shown();
  command.add_option("--imu", options->imus, "Simulated IMUs; none: without")
      .separated_by_commas()
      .default_shown();
  command.add_option("--conditions", options->conditions, "Simulated conditions")
      .one_of({"ideal", "field"})
      .default_shown();
  command.add_option("--page", options->page,
                     "Markdown file whose section between 'uncertainty' marks takes the table");
}

}  // namespace adit::app

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/doctor.hpp"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>

#include "adit/core/format.hpp"
#include "adit/core/json_text.hpp"
#include "adit/io/bag.hpp"
#include "adit/io/recording_files.hpp"
#include "command_line.hpp"
#include "inputs.hpp"

namespace adit::app {
namespace {

struct DoctorOptions {
  std::string input;
  RecordingConfig recording;
};

std::string_view mark_of(Health health) {
  switch (health) {
    case Health::good:
      return "ok     ";
    case Health::noted:
      return "note   ";
    case Health::spoils:
      return "PROBLEM";
    case Health::unknown:
      break;
  }
  return "?      ";
}

void print_text(const std::vector<Diagnosis>& found) {
  for (const Diagnosis& one : found) {
    std::printf("%s  %s: %s\n", std::string(mark_of(one.health)).c_str(), one.check.c_str(),
                one.sentence.c_str());
    if (!one.remedy.empty()) std::printf("           -> %s\n", one.remedy.c_str());
  }
}

void print_json(const std::vector<Diagnosis>& found) {
  nlohmann::ordered_json checks = nlohmann::ordered_json::array();
  for (const Diagnosis& one : found)
    checks.push_back({{"check", one.check},
                      {"health", to_string(one.health)},
                      {"found", one.sentence},
                      {"remedy", one.remedy}});
  std::printf("%s\n", json_text(nlohmann::ordered_json{{"checks", checks}}, 2).c_str());
}

Result<> doctor_command(const DoctorOptions& options, const Common& common) {
  const Result<RunConfig> config = configured(common);
  if (!config) return tl::unexpected(config.error());
  const RecordingConfig how = recording_config(config->recording, options.recording);
  const Result<Recording> recording = open_recording(options.input, how);
  if (!recording) return tl::unexpected(recording.error());
  const bool is_bag = is_bag_file(options.input) || is_bag_folder(options.input);
  Result<std::vector<Diagnosis>> found =
      diagnose(*recording, config->slam.robot, is_bag ? RecordedAs::bag : RecordedAs::folder_of_clouds);
  if (!found) return tl::unexpected(found.error());
  if (is_bag) {
    const Result<Bag> bag = open_bag(options.input);
    if (!bag) return tl::unexpected(bag.error());
    std::ranges::move(diagnose_clocks(*bag, how), std::back_inserter(*found));
  }
  common.json ? print_json(*found) : print_text(*found);
  const auto num = std::ranges::count(*found, Health::spoils, &Diagnosis::health);
  if (num > 0)
    return fail(format("{}: {} of {} checks found what spoils a map", options.input, num, found->size()));
  return {};
}

}  // namespace

void add_doctor(Program& program) {
  const auto options = std::make_shared<DoctorOptions>();
  const Command command = program.add_command(
      "doctor", "Check a recording for what spoils a map: frames, times, mount, drop-outs",
      [options](const Common& common) { return doctor_command(*options, common); });
  command.add_option("input", options->input, "Recording or folder of scans").required();
  add_recording_options(command, options->recording);
  add_truth_topic(command, options->recording);
  command.footer(
      "Every check says what it found and what to do. The exit code is 1 where something spoils a map.");
}

}  // namespace adit::app

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "adit/core/format.hpp"
#include "adit/core/json_text.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/progress.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/bag_recording.hpp"
#include "adit/io/tum.hpp"
#include "adit/io/world_files.hpp"
#include "adit/slam/naming.hpp"
#include "command_line.hpp"
#include "inputs.hpp"

namespace adit::app {
namespace {

struct SimulateOptions {
  std::string world;
  std::string routes;
  std::string out;
  SimulationOptions simulation;
  std::string robot;
  std::optional<std::uint64_t> seed;
};

std::filesystem::path recording_file(const SimulateOptions& options, const Recording& recording) {
  return std::filesystem::path(options.out) / (recording.name + ".mcap");
}

std::filesystem::path truth_file(const SimulateOptions& options, const Recording& recording) {
  return std::filesystem::path(options.out) / (recording.name + "_truth.tum");
}

// A robot's noise does not depend on which robots are wanted: all are set up, and the others are left out.
Result<std::vector<Recording>> chosen(std::vector<Recording> recordings, const std::string& robot) {
  if (robot.empty()) return recordings;
  std::string names;
  for (const Recording& recording : recordings) {
    if (recording.name == robot) return std::vector<Recording>{recording};
    names += (names.empty() ? "" : ", ") + recording.name;
  }
  return fail("no robot is called '" + robot + "'; the routes have " + names);
}

/// Removes a folder at the end of its scope, however that is reached, if nothing is in it.
class RemoveIfEmpty {
 public:
  explicit RemoveIfEmpty(std::filesystem::path folder) : folder_(std::move(folder)) {}
  ~RemoveIfEmpty() {
    std::error_code error;
    std::filesystem::remove(folder_, error);
  }
  RemoveIfEmpty(const RemoveIfEmpty&) = delete;
  RemoveIfEmpty& operator=(const RemoveIfEmpty&) = delete;

 private:
  std::filesystem::path folder_;
};

std::filesystem::path faults_file(const SimulateOptions& options, const Recording& recording) {
  return std::filesystem::path(options.out) / (recording.name + "_faults.csv");
}

/// What sensors were made to do wrong, to judge by: no file where that is nothing.
Result<> write_faults(const SimulateOptions& options, const Recording& recording) {
  if (recording.faults.empty()) return {};
  std::string text = "sensor,kind,begin_s,end_s,amount\n";
  for (const SensorFault& fault : recording.faults) {
    text += format("{},{},{},{},{}\n", fault.sensor, fault.kind, stamp_text(fault.begin),
                   stamp_text(fault.end), fault.amount);
  }
  return write_bytes(faults_file(options, recording), text);
}

/// Each scan that is read is a step of `phase`.
Result<> write(const SimulateOptions& options, Recording recording, const Phase& phase) {
  recording.read_scan = [&, read = std::move(recording.read_scan)](std::size_t i) {
    phase.advance();
    return read(i);
  };
  return write_recording(recording_file(options, recording), recording)
      .and_then([&] { return write_tum(truth_file(options, recording), recording.truth); })
      .and_then([&] { return write_faults(options, recording); });
}

Result<> write_all(const SimulateOptions& options, const std::vector<Recording>& recordings) {
  std::error_code error;
  std::filesystem::create_directories(options.out, error);
  if (error) return fail(options.out + ": cannot make this folder: " + error.message());
  const RemoveIfEmpty guard(options.out);  // recordings that are complete stay, a folder without any goes
  std::size_t num_scans = 0;
  for (const Recording& recording : recordings) num_scans += recording.num_scans();
  const Phase phase("simulating", num_scans);
  std::vector<Result<>> written(recordings.size());
  parallel_for_each(recordings.size(),
                    [&](std::size_t i) { written[i] = write(options, recordings[i], phase); });
  const auto failed = std::ranges::find_if(written, [](const Result<>& done) { return !done; });
  return failed == written.end() ? Result<>() : *failed;
}

void print(const SimulateOptions& options, const std::vector<Recording>& recordings, const Common& common) {
  nlohmann::ordered_json report;
  for (const Recording& recording : recordings) {
    const std::string file = recording_file(options, recording).string();
    const double length = path_length(recording.truth);
    const double duration = to_seconds(recording.truth.back().stamp - recording.truth.front().stamp);
    report["recordings"].push_back({{"robot", recording.name},
                                    {"file", file},
                                    {"truth", truth_file(options, recording).string()},
                                    {"scans", recording.num_scans()},
                                    {"path_length_m", length},
                                    {"duration_s", duration}});
    if (common.json) continue;
    std::printf("%s: %zu scans, %.1f m in %.1f s\n", file.c_str(), recording.num_scans(), length, duration);
  }
  if (common.json) std::printf("%s\n", json_text(report).c_str());
}

Result<> simulate_command(const SimulateOptions& options, const Common& common) {
  Result<RunConfig> config = configured(common, options.simulation);
  if (!config) return tl::unexpected(config.error());
  if (options.seed) config->simulation.seed = *options.seed;
  auto recordings =
      load_world(options.world, options.routes)
          .and_then([&](const World& world) { return simulate(world, config->simulation); })
          .and_then([&](const std::vector<Recording>& all) { return chosen(all, options.robot); });
  if (!recordings) return tl::unexpected(recordings.error());
  print_notes("simulate", name_robots(*recordings));
  if (Result<> written = write_all(options, *recordings); !written) return written;
  print(options, *recordings, common);
  return {};
}

}  // namespace

void add_simulate(Program& program) {
  const auto options = std::make_shared<SimulateOptions>();
  const Command command = program.add_command(
      "simulate", "Drive robots through a mesh: one recording per robot, with ground truth",
      [options](const Common& common) { return simulate_command(*options, common); });
  command.add_option("--world", options->world,
                     "Mesh: PLY, OBJ, STL, DAE, GLB (default: the one the routes name)");
  command.add_option("--routes", options->routes, "routes.yaml").required();
  command
      .add_option("--out", options->out,
                  "Folder for ROBOT.mcap, ROBOT_truth.tum and, where sensors fail, ROBOT_faults.csv")
      .required();
  add_simulation_options(command, options->simulation);
  command.add_option(
      "--imu", options->simulation.imu,
      format("Simulated IMU: {}, or none (default: icm-20948)", fmt::join(imu_presets(), ", ")));
  command.add_option("--robot", options->robot, "Only the robot of this name");
  command.add_option("--seed", options->seed, "Noise seed; overrides --set and --config");
}

}  // namespace adit::app

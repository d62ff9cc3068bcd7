// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "inputs.hpp"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/io/bag.hpp"
#include "adit/io/bag_topics.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/routes_yaml.hpp"
#include "adit/io/world_files.hpp"

namespace adit::app {
namespace {

/// By its name. The metadata.yaml of a bag is no routes file: opening it as a recording fails and names the
/// folder of the bag, which is what to give.
bool is_routes_file(const std::string& input) {
  const std::string extension = std::filesystem::path(input).extension().string();
  if (extension != ".yaml" && extension != ".yml") return false;
  return check_not_metadata(name_and_path(input).second).has_value();
}

Result<Inputs> simulated(const std::string& routes_file, const ScenarioConfig& simulation) {
  const Result<RoutesFile> routes = read_routes(routes_file);
  if (!routes) return tl::unexpected(routes.error());
  return load_world({}, routes_file)
      .and_then([&](const World& world) { return simulate(world, simulation); })
      .map([&](std::vector<Recording> recordings) {
        return Inputs{std::move(recordings), routes->world.string()};
      });
}

void print_remarks(const std::string& input, const Recording& recording) {
  for (const std::string& warning : recording.warnings)
    std::fprintf(stderr, "adit: %s: warning: %s\n", input.c_str(), warning.c_str());
  for (const std::string& assumption : recording.assumptions)
    std::fprintf(stderr, "adit: %s: assumed %s\n", input.c_str(), assumption.c_str());
}

/// One recording of each robot in a bag.
Result<Inputs> open_robots(const std::string& path, RecordingConfig config) {
  if (!config.topics_under.empty())
    return fail("recording.topics_under names one robot, and --namespaces asks for all; give one of them");
  if (const Result<> whole = check_not_metadata(path); !whole) return tl::unexpected(whole.error());
  if (!is_bag_file(path) && !is_bag_folder(path))
    return fail(path + ": is no bag; --namespaces is for bags of several robots");
  const Result<Bag> bag = open_bag(path);
  if (!bag) return tl::unexpected(bag.error());
  const std::vector<std::string> robots = namespaces_of(*bag);
  if (robots.empty())
    return fail(path + ": no topic of clouds lies in a namespace (/ROBOT/points); leave --namespaces out");
  Inputs opened;
  const std::string of_bag = path + ": ";
  for (const std::string& robot : robots) {
    config.topics_under = robot;
    Result<Recording> recording = open_recording(path, config);
    if (!recording) {
      opened.failed.push_back({robot, robot + ": " + recording.error().message});
      continue;
    }
    if (!opened.recordings.empty())  // those of the file are said of the first
      std::erase_if(recording->warnings, [&](const std::string& warning) {
        return std::ranges::find(bag->warnings, warning) != bag->warnings.end();
      });
    print_remarks(of_bag + robot, *recording);
    opened.recordings.push_back(std::move(*recording));
  }
  if (opened.recordings.empty()) return fail(reasons_of(opened.failed));
  return opened;
}

std::string mount_fault(const std::string& text) {
  const Result<Pose> mount = parse_mount(text);
  return mount ? std::string() : mount.error().message;
}

}  // namespace

void add_recording_options(const Command& command, RecordingConfig& config) {
  command
      .add_option(
          "--mount", config.mount,
          "Pose of the LiDAR on the robot, X,Y,Z[,ROLL,PITCH,YAW] in metres and degrees; overrides what "
          "recordings say")
      .check(mount_fault);
  command.add_option("--points", config.points, "Topic of the clouds, for recordings with several");
  command.add_option(
      "--wheel", config.wheel,
      "Topic of the wheel odometry, for recordings with several or with a TwistStamped or JointState; none: "
      "without");
  command.add_option("--imu", config.imu, "Topic of the IMU, for recordings with several; none: without");
  command.add_option("--imu-mount", config.imu_mount, "Pose of the IMU on the robot, as --mount")
      .check(mount_fault);
  command.add_option(
      "--tf", config.tf,
      "Topics of the links between frames, apart by commas (default: all called tf or tf_static)");
  command
      .add_option("--point-times", config.point_times,
                  "Unit of the times of points, s, ms, us or ns (default: as found)")
      .one_of({"s", "ms", "us", "ns"});
  command.add_option("--point-time-field", config.point_time_field,
                     "Field with the times of points (default: as found)");
  command
      .add_option("--bin-columns", config.bin_columns,
                  format("Columns of .bin clouds, {} to {} (default: four or five, as found)",
                         kLeastBinColumns, kMostBinColumns))
      .in_range(kLeastBinColumns, kMostBinColumns);
}

void add_truth_topic(const Command& command, RecordingConfig& config) {
  command.add_option("--truth", config.truth,
                     "Topic of ground truth, for recordings with several; none: without");
}

Result<Recording> open_input(const std::string& input, const RecordingConfig& config) {
  return open_recording(input, config).map([&](Recording recording) {
    print_remarks(input, recording);
    return recording;
  });
}

RecordingConfig recording_config(RecordingConfig config, const RecordingConfig& options) {
  if (!options.mount.empty()) config.mount = options.mount;
  if (!options.points.empty()) config.points = options.points;
  if (!options.wheel.empty()) config.wheel = options.wheel;
  if (!options.imu.empty()) config.imu = options.imu;
  if (!options.imu_mount.empty()) config.imu_mount = options.imu_mount;
  if (!options.tf.empty()) config.tf = options.tf;
  if (!options.truth.empty()) config.truth = options.truth;
  if (!options.point_times.empty()) config.point_times = options.point_times;
  if (!options.point_time_field.empty()) config.point_time_field = options.point_time_field;
  if (options.bin_columns != 0) config.bin_columns = options.bin_columns;
  config.namespaces |= options.namespaces;
  return config;
}

Result<Inputs> open_inputs(const std::vector<std::string>& inputs, const RunConfig& config) {
  if (inputs.size() == 1 && is_routes_file(inputs.front())) {
    ScenarioConfig simulation = config.simulation;
    if (config.recording.imu == kNoImu) simulation.imu.on = false;
    if (config.recording.wheel == kNoWheel) simulation.wheels.on = false;
    return simulated(inputs.front(), simulation);
  }
  Inputs opened;
  for (const std::string& input : inputs) {
    if (is_routes_file(input))
      return fail(input + ": a routes file names all robots; give no other input with it");
    const auto [name, path] = name_and_path(input);
    if (config.recording.namespaces) {
      Result<Inputs> robots = open_robots(path, config.recording);
      if (!robots) return tl::unexpected(robots.error());
      std::ranges::move(robots->failed, std::back_inserter(opened.failed));
      for (Recording& robot : robots->recordings) {
        if (!name.empty()) robot.name = name + "_" + robot.name;
        opened.recordings.push_back(std::move(robot));
      }
      continue;
    }
    Result<Recording> recording = open_input(path, config.recording);
    if (!recording) return tl::unexpected(recording.error());
    if (!name.empty()) recording->name = name;
    opened.recordings.push_back(std::move(*recording));
  }
  return opened;
}

std::pair<std::string, std::string> name_and_path(const std::string& input) {
  const std::size_t equals = input.find('=');
  if (equals == std::string::npos || equals == 0 || std::filesystem::exists(input)) return {"", input};
  return {input.substr(0, equals), input.substr(equals + 1)};
}

Result<> choose_lidars(const std::string& names, ScenarioConfig& config) {
  ScenarioConfig chosen = config;
  chosen.lidars = names;
  return lidars_of(chosen).map([&](const std::vector<LidarConfig>& lidars) {
    config.lidar = lidars.front();
    config.lidars = lidars.size() == 1 ? "" : names;
  });
}

Result<> choose_imu(const std::string& name, ScenarioConfig& config) {
  config.imu.on = name != kNoImu;
  if (!config.imu.on) return {};
  return imu_preset(name).map([&](const ImuConfig& imu) { config.imu = imu; });
}

}  // namespace adit::app

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "adit/core/format.hpp"
#include "adit/core/json_text.hpp"
#include "adit/core/progress.hpp"
#include "adit/evaluation/ate.hpp"
#include "adit/evaluation/statistics.hpp"
#include "adit/io/bag.hpp"
#include "adit/io/tum.hpp"
#include "adit/odometry/methods.hpp"
#include "adit/robot/nothing_mapped.hpp"
#include "adit/robot/robot_slam.hpp"
#include "adit/robot/scan_loop.hpp"
#include "adit/robot/sensor_checks.hpp"
#include "command_line.hpp"
#include "inputs.hpp"
#include "outputs.hpp"

namespace adit::app {
namespace {

struct OdometryOptions {
  RecordingConfig recording;
  std::string input;
  std::string method;
  std::string out;
  std::string truth;
};

struct Run {
  Trajectory trajectory;
  std::vector<double> scan_ms;
  std::map<StepStatus, int> statuses;
};

Result<Run> run(const Recording& recording, const OdometryConfig& config) {
  const Result<> wheels = check_wheels(recording, config, "--method kiss-icp");
  if (!wheels) return tl::unexpected(wheels.error());
  const std::unique_ptr<Odometry> odometry = make_odometry(config, recording.T_base_lidar);
  const Phase phase("odometry", recording.num_scans());
  Run out;
  const auto take = [&](const Scan& scan, const SensedMotion& motion) {
    const auto start = std::chrono::steady_clock::now();
    const OdometryStep step = odometry->register_scan(scan, motion);
    out.scan_ms.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    out.trajectory.push_back({step.stamp, step.T_odom_base});
    ++out.statuses[step.status];
    phase.advance();
    return true;
  };
  LeftOut left_out("scans");
  const Result<> done = for_each_scan(with_damaged_scans_empty(recording, left_out), take);
  if (!done) return tl::unexpected(done.error());
  if (const Result<> any = left_out.unless_all(); !any) return fail(recording.name, any.error());
  if (const auto sentence = left_out.sentence()) print_notes("odometry", {*sentence});
  return out;
}

std::string status_line(const std::map<StepStatus, int>& statuses) {
  std::string line;
  for (const auto& [status, count] : statuses)
    line += format("{}{} {}", line.empty() ? "" : ", ", count, to_string(status));
  return line;
}

std::vector<std::string> checked_sensors(Recording& recording) {
  std::vector<std::string> notes;
  for (const SensorFinding& finding : use_sound_sensors(recording)) notes.push_back(finding.sentence);
  return notes;
}

Result<> odometry(const OdometryOptions& options, const Common& common) {
  Result<RunConfig> config = configured(common);
  if (!config) return tl::unexpected(config.error());
  OdometryConfig& method = config->slam.robot.odometry;
  if (!options.method.empty()) {
    if (const Result<> set = set_field(fields_of(method), "method", options.method); !set)
      usage_error(set.error().message);
  }
  const bool is_truth_topic = options.truth == kNoTruth ||
                              ((is_bag_file(options.input) || is_bag_folder(options.input)) &&
                               options.truth.starts_with('/') && !std::filesystem::exists(options.truth));
  RecordingConfig how = recording_config(config->recording, options.recording);
  if (is_truth_topic) how.truth = options.truth;
  Result<Recording> recording = open_input(options.input, how);
  if (!recording) return tl::unexpected(recording.error());
  if (config->slam.check_sensors) print_notes("odometry", checked_sensors(*recording));
  if (options.method.empty()) {  // as adit slam does
    if (const auto note = use_kiss_icp_without_sensors(*recording, method)) print_notes("odometry", {*note});
  }
  Result<Trajectory> truth = recording->truth;
  if (!options.truth.empty() && !is_truth_topic) truth = read_tum(options.truth);
  if (!truth) return tl::unexpected(truth.error());
  const Result<Run> done = run(*recording, method);
  if (!done) return tl::unexpected(done.error());
  if (is_nothing_mapped(done->statuses)) return fail(why_nothing_mapped(*recording));
  if (const Result<> written = write_tum(options.out, done->trajectory); !written) return written;

  nlohmann::ordered_json report = {{"scans", done->trajectory.size()},
                                   {"ms_per_scan_median", median(done->scan_ms)}};
  std::string line = format("{}: {} scans ({}), {:.1f} m, {:.1f} ms per scan (median)", recording->name,
                            done->trajectory.size(), status_line(done->statuses),
                            path_length(done->trajectory), median(done->scan_ms));
  if (!truth->empty()) {
    const Result<AteResult> error = ate(done->trajectory, *truth);
    if (!error) return fail(options.truth.empty() ? "ground truth" : options.truth, error.error());
    report["ate_max_m"] = error->max_m;
    report["ate_rmse_m"] = error->rmse_m;
    line += format(", ATE max {:.3f} m, rmse {:.3f} m", error->max_m, error->rmse_m);
  }
  std::printf("%s\n", common.json ? json_text(report).c_str() : line.c_str());
  return {};
}

}  // namespace

void add_odometry(Program& program) {
  const auto options = std::make_shared<OdometryOptions>();
  const Command command =
      program.add_command("odometry", "Compute the odometry of one robot",
                          [options](const Common& common) { return odometry(*options, common); });
  command.add_option("input", options->input, "Recording (.mcap, .db3, .bag, bag folder) or folder of scans")
      .required();
  command
      .add_option("--method", options->method,
                  "plane-icp (default with wheels or an IMU), kinematic-icp (needs wheels) or "
                  "kiss-icp (LiDAR alone; default without both)")
      .one_of({"plane-icp", "kinematic-icp", "kiss-icp"});
  command.add_option("--out", options->out, "Trajectory to write (TUM)")
      .required()
      .check(trajectory_name_fault);
  command.add_option("--truth", options->truth,
                     "True trajectory for the error, a file (TUM) or a topic (default: the recording's own)");
  add_recording_options(command, options->recording);
}

}  // namespace adit::app

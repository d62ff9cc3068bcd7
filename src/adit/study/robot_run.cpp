// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/robot_run.hpp"

#include <algorithm>
#include <chrono>

#include "adit/core/parallel.hpp"
#include "adit/core/progress.hpp"
#include "adit/core/robot_ids.hpp"
#include "adit/evaluation/ate.hpp"
#include "adit/evaluation/statistics.hpp"
#include "adit/robot/nothing_mapped.hpp"
#include "adit/slam/mapping.hpp"
#include "adit/slam/robot_facts.hpp"

namespace adit {
namespace {

/// Milliseconds that `work` takes.
template <class Work>
double timed_ms(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

OdometryResult odometry_result(const std::string& method, const Trajectory& estimate, const Trajectory& truth,
                               const std::vector<double>& scan_ms) {
  OdometryResult result;
  result.method = method;
  if (const Result<AteResult> error = ate(estimate, truth)) result.ate = *error;
  if (!scan_ms.empty()) result.ms_per_scan_median = median(scan_ms);
  return result;
}

std::string json_name(OdometryMethod method) {
  std::string name(to_string(method));
  std::ranges::replace(name, '-', '_');
  return name;
}

/// A robot's drive under one odometry.
class Drive {
 public:
  Drive(const Recording& recording, RobotId id, RobotSlamConfig config, OdometryMethod method)
      : method_(method), slam_(id, recording.name, with_method(config, method), recording.T_base_lidar) {}

  void process(const Scan& scan, const SensedMotion& motion) {
    RobotStep step;
    const double ms = timed_ms([&] { step = slam_.process(scan, motion); });
    if (!step.keyframe) ms_.push_back(ms);
  }
  [[nodiscard]] OdometryMethod method() const { return method_; }
  [[nodiscard]] const RobotMap& map() const { return slam_.map(); }
  [[nodiscard]] OdometryResult result(const Trajectory& truth) const {
    return odometry_result(json_name(method_), slam_.map().odometry, truth, ms_);
  }

 private:
  static RobotSlamConfig with_method(RobotSlamConfig config, OdometryMethod method) {
    config.odometry.method = method;
    return config;
  }

  OdometryMethod method_;
  RobotSlam slam_;
  std::vector<double> ms_;  ///< Of scans that became no keyframe, so that it is the odometry's time alone.
};

/// KISS-ICP beside the drives, for the comparison of section 3.1, unless one of them is KISS-ICP itself.
class Comparison {
 public:
  Comparison(const Recording& recording, const RobotSlamConfig& config, bool is_on)
      : odometry_(config.odometry.kiss_icp, recording.T_base_lidar), is_on_(is_on) {}

  void process(const Scan& scan) {
    if (!is_on_) return;
    OdometryStep step;
    ms_.push_back(timed_ms([&] { step = odometry_.register_scan(scan, {}); }));
    trajectory_.push_back({step.stamp, step.T_odom_base});
  }
  void add_result(const Trajectory& truth, std::vector<OdometryResult>& results) const {
    if (is_on_) results.push_back(odometry_result("kiss_icp", trajectory_, truth, ms_));
  }

 private:
  KissIcp odometry_;
  bool is_on_;
  Trajectory trajectory_;
  std::vector<double> ms_;
};

Result<RobotRun> run_robot(const Recording& recording, RobotId id, const RunConfig& config,
                           const Phase& phase) {
  const RobotSlamConfig& robot = config.slam.robot;
  std::vector<Drive> drives;
  drives.emplace_back(recording, id, robot, robot.odometry.method);
  if (config.paper_odometry != robot.odometry.method)
    drives.emplace_back(recording, id, robot, config.paper_odometry);
  const bool has_kiss_icp =
      std::ranges::find(drives, OdometryMethod::kiss_icp, &Drive::method) != drives.end();
  Comparison comparison(recording, robot, !has_kiss_icp);
  const Result<> driven = for_each_scan(recording, [&](const Scan& scan, const SensedMotion& motion) {
    for (Drive& drive : drives) drive.process(scan, motion);
    comparison.process(scan);
    phase.advance();
    return true;
  });
  if (!driven) return tl::unexpected(driven.error());
  RobotRun run;
  run.map = std::make_shared<const RobotMap>(drives.front().map());
  run.paper_map = drives.size() == 1 ? run.map : std::make_shared<const RobotMap>(drives.back().map());
  if (run.map->keyframes.empty() || run.paper_map->keyframes.empty())
    return fail(why_nothing_mapped(recording));
  run.lidar = recording.lidar;
  run.truth = recording.truth;
  run.result = robot_facts(*run.map, run.truth);
  comparison.add_result(run.truth, run.result.odometry);
  std::for_each(drives.rbegin(), drives.rend(), [&run](Drive& drive) {  // the paper's first
    run.result.odometry.push_back(drive.result(run.truth));
  });
  return run;
}

/// The values, or the error of the first robot that failed.
template <class T>
Result<std::vector<T>> all_or_first_error(std::vector<Result<T>> results) {
  std::vector<T> values;
  for (Result<T>& result : results) {
    if (!result) return tl::unexpected(result.error());
    values.push_back(std::move(*result));
  }
  return values;
}

}  // namespace

Result<std::vector<RobotRun>> run_robots(const std::vector<Recording>& recordings, const RunConfig& config) {
  const Result<std::vector<RobotId>> ids = robot_ids(recordings.size());
  if (!ids) return tl::unexpected(ids.error());
  const Phase phase("mapping", num_scans(recordings));
  std::vector<Result<RobotRun>> runs(recordings.size(), fail("not run"));
  parallel_for_each(recordings.size(),
                    [&](std::size_t i) { runs[i] = run_robot(recordings[i], (*ids)[i], config, phase); });
  return all_or_first_error(std::move(runs));
}

std::vector<std::shared_ptr<const RobotMap>> selected_maps(const std::vector<const RobotRun*>& runs,
                                                           const SlamConfig& config) {
  std::vector<std::shared_ptr<const RobotMap>> maps;
  for (const RobotRun* run : runs) {
    maps.push_back(std::make_shared<const RobotMap>(
        select_keyframes(*run->map_for(config.keyframes), config.keyframes, config.robot.tunnel_filter)));
  }
  return maps;
}

}  // namespace adit

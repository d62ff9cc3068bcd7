// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/scan_motion.hpp"

#include <algorithm>
#include <cmath>

#include "adit/evaluation/statistics.hpp"
#include "adit/geometry/deskew.hpp"
#include "adit/odometry/plane_icp.hpp"
#include "adit/odometry/preprocess.hpp"

namespace adit {
namespace {

constexpr std::size_t kPoints = 20'000;  // of a scan; more measure no better

// About kPoints of the points, spread evenly and without a period that could be that of the rings.
PointCloud thinned(const PointCloud& cloud) {
  if (cloud.size() <= kPoints) return cloud;
  const double share = static_cast<double>(kPoints) / static_cast<double>(cloud.size());
  constexpr double kGolden = 0.6180339887498949;
  PointCloud out;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double position = static_cast<double>(i) * kGolden;
    if (position - std::floor(position) >= share) continue;
    out.points.push_back(cloud.points[i]);
    if (cloud.has_times()) out.time_offsets_ns.push_back(cloud.time_offsets_ns[i]);
  }
  return out;
}

// The odometry of clouds without times of their points.
std::vector<OdometryStep> registered(const std::vector<Scan>& scans, const Pose& T_base_lidar) {
  PlaneIcpConfig config;
  config.scan_to_map.deskew = false;
  PlaneIcp odometry(config, T_base_lidar);
  std::vector<OdometryStep> steps;
  for (const Scan& scan : scans) steps.push_back(odometry.register_scan(scan, {}));
  return steps;
}

// The clouds as if each had been taken at the scan's stamp, base frame. Deskewing within the odometry goes by
// the motion that is sought, and answers errors of one scan with others of the next. So sweeps are registered
// bent as they are first, which gives the motion at their middles, and straightened by that.
std::vector<Scan> straightened(const std::vector<Scan>& scans, const Pose& T_base_lidar) {
  const std::vector<OdometryStep> bent = registered(scans, T_base_lidar);
  std::vector<Scan> out;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    const std::size_t before = k == 0 ? 0 : k - 1;
    const std::size_t after = std::min(k + 1, scans.size() - 1);
    const Pose motion = bent[before].T_odom_base.inverse() * bent[after].T_odom_base;
    PointCloud straight;
    preprocess(scans[k].cloud, {}, T_base_lidar, sweep_of({motion, bent[after].stamp - bent[before].stamp}),
               straight);
    out.push_back({scans[k].stamp, std::move(straight)});
  }
  return out;
}

}  // namespace

std::vector<std::size_t> scans_to_check(const Recording& recording) {
  constexpr double kInterval = 0.1;
  if (recording.num_scans() < 2) return {};
  std::vector<double> intervals;
  for (std::size_t i = 1; i < recording.num_scans(); ++i)
    intervals.push_back(to_seconds(recording.scan_stamps[i] - recording.scan_stamps[i - 1]));
  const auto step = static_cast<std::size_t>(std::max(1.0, std::round(kInterval / median(intervals))));
  std::vector<std::size_t> used;
  for (std::size_t i = 0; i < recording.num_scans(); i += step) used.push_back(i);
  return used;
}

ScanMotion motion_of_scans(const Recording& recording, std::span<const std::size_t> indices) {
  ScanMotion motion;
  std::vector<Scan> scans;
  for (const std::size_t i : indices) {
    const Result<Scan> scan = recording.read_scan(i);
    if (!scan || scan->cloud.empty()) continue;  // damaged, or nothing was in view
    motion.has_times = motion.has_times && scan->cloud.has_times();
    scans.push_back({scan->stamp, thinned(scan->cloud)});
  }
  if (scans.size() >= 2) motion.steps = registered(straightened(scans, recording.T_base_lidar), Pose());
  return motion;
}

std::vector<std::size_t> spread_over(std::size_t num_all, std::size_t num) {
  std::vector<std::size_t> chosen;
  const std::size_t n = std::min(num_all, num);
  for (std::size_t i = 0; i < n; ++i) chosen.push_back(i * num_all / n);
  return chosen;
}

}  // namespace adit

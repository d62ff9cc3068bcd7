// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/doctor_mapping.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/robot/scan_loop.hpp"
#include "adit/robot/scan_motion.hpp"

namespace adit {
namespace {

/// `length` scans of a recording, as one of their own.
Recording stretch_of(const Recording& recording, std::size_t first, std::size_t length) {
  Recording stretch = recording;
  const auto begin = recording.scan_stamps.begin() + static_cast<std::ptrdiff_t>(first);
  stretch.scan_stamps.assign(begin, begin + static_cast<std::ptrdiff_t>(length));
  stretch.read_scan = [read = recording.read_scan, first](std::size_t i) { return read(first + i); };
  return stretch;
}

/// What the odometry does with points, and the keys that lead to it.
std::pair<ScanToMapConfig, std::string> settings_of_points(const OdometryConfig& config) {
  const std::string keys = "robot.odometry.";
  switch (config.method) {
    case OdometryMethod::kiss_icp:
      return {config.kiss_icp.scan_to_map, keys + "kiss_icp."};
    case OdometryMethod::kinematic_icp:
      return {config.kinematic_icp.scan_to_map, keys + "kinematic_icp."};
    case OdometryMethod::plane_icp:
      break;
  }
  return {config.plane_icp.scan_to_map, keys + "plane_icp."};
}

/// By what the scans look like.
std::string remedy_of_no_map(const Recording& recording, const ScansSeen& seen,
                             const OdometryConfig& odometry) {
  constexpr double kFewPoints = 500.0;
  constexpr double kNarrow = 60.0;    // degrees, half the opening
  constexpr double kFewVoxels = 8.0;  // from the sensor to the farthest point
  const auto [used, keys] = settings_of_points(odometry);
  if (recording.num_scans() < 2) return "record a drive: the robot has to be seen moving";
  if (seen.median_m >= used.max_range)
    return format(
        "points are in metres: where these are in millimetres, divide x, y and z by 1000 where the clouds "
        "are made; else --set {}max_range={:.0f}",
        keys, std::ceil(seen.farthest_m));
  if (seen.median_m <= used.min_range)
    return format("--set {}min_range={:.1f}: half of the returns are nearer than the {} m that it is", keys,
                  std::floor(10.0 * seen.nearest_m) / 10.0, used.min_range);
  if (seen.points < kFewPoints) return "let the driver send whole sweeps with all of their points";
  if (seen.cone_deg < kNarrow)
    return "map with a LiDAR that sees the walls around it; of a bag that has one, --points takes its clouds";
  if (seen.farthest_m < kFewVoxels * used.voxel_size)
    return format(
        "points are in metres: where these are not, scale them where the clouds are made; in a place this "
        "small --set {}voxel_size={:.2f}",
        keys, std::max(0.01, seen.farthest_m / (2.0 * kFewVoxels)));
  return format("repair first what the other checks found; if they found nothing, --set {}voxel_size={:.2f}",
                keys, std::max(0.01, 0.5 * used.voxel_size));
}

}  // namespace

Diagnosis diagnose_mapping(const Recording& recording, const ScansSeen& seen, RobotSlamConfig config) {
  constexpr std::size_t kLength = 25;  // scans
  constexpr std::size_t kStretches = 3;
  const std::size_t length = std::min(kLength, recording.num_scans());
  [[maybe_unused]] const std::optional<std::string> note =
      use_kiss_icp_without_sensors(recording, config.odometry);
  std::string why;
  const std::vector<std::size_t> starts = spread_over(recording.num_scans() - length + 1, kStretches);
  for (const std::size_t first : starts) {
    LeftOut left_out("scans");
    const Recording stretch = with_damaged_scans_empty(stretch_of(recording, first, length), left_out);
    const Result<RobotMap> map = map_recording(stretch, {0}, config);
    if (map)
      return {"mapping", Health::good,
              format("odometry follows the scans from {:.1f} s on",
                     to_seconds(recording.scan_stamps[first] - recording.scan_stamps.front()))};
    if (why.empty()) why = map.error().message;
  }
  std::size_t num_looked_at = 0;  // stretches of a short recording overlap
  for (std::size_t i = 0; i < starts.size(); ++i)
    num_looked_at += i + 1 < starts.size() ? std::min(length, starts[i + 1] - starts[i]) : length;
  return {"mapping", Health::spoils,
          format("nothing can be mapped, by {} of {} scans: {}", num_looked_at, recording.num_scans(), why),
          remedy_of_no_map(recording, seen, config.odometry)};
}

}  // namespace adit

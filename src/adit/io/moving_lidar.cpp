// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/moving_lidar.hpp"

#include <map>

#include "adit/core/check.hpp"

namespace adit {

void hold_still(Scan& scan, const MovingPose& T_base_moving, const Pose& T_base_lidar) {
  // Points of one moment have one pose; within 50 us a joint that turns once a second turns by 0.02 degrees.
  constexpr std::int32_t kMoment = 50'000;  // nanoseconds
  const Pose T_lidar_base = T_base_lidar.inverse();
  const std::optional<Pose> at_stamp = T_base_moving.at(scan.stamp);
  ADIT_CHECK(at_stamp.has_value(), "scans without a pose of their LiDAR are left out");
  std::map<std::int32_t, Eigen::Isometry3f> poses;
  const auto pose_in = [&](std::int32_t moment) -> const Eigen::Isometry3f& {
    const auto known = poses.find(moment);
    if (known != poses.end()) return known->second;
    const Stamp stamp = scan.stamp + Duration(std::int64_t{moment} * kMoment);
    const Pose T = T_lidar_base * T_base_moving.at(stamp).value_or(*at_stamp);
    return poses.emplace(moment, Eigen::Isometry3d(T.matrix()).cast<float>()).first->second;
  };
  PointCloud& cloud = scan.cloud;
  std::int32_t last = 0;
  const Eigen::Isometry3f* T = &pose_in(last);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::int32_t moment = cloud.has_times() ? cloud.time_offsets_ns[i] / kMoment : 0;
    if (moment != last) T = &pose_in(last = moment);
    cloud.points[i] = *T * cloud.points[i];
  }
}

}  // namespace adit

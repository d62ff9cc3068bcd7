// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/full_rate.hpp"

#include "adit/core/check.hpp"

namespace adit {

Trajectory at_every_scan(const RobotMap& map, const std::vector<Pose>& T_world_keyframe) {
  const std::vector<Keyframe>& keyframes = map.keyframes;
  ADIT_CHECK(T_world_keyframe.size() == keyframes.size(), "a pose for each keyframe");
  Trajectory out;
  if (keyframes.empty()) return out;
  std::size_t k = 0;  // the last keyframe that is not after the scan, or the first
  for (const StampedPose& scan : map.odometry) {
    while (k + 1 < keyframes.size() && keyframes[k + 1].stamp <= scan.stamp) ++k;
    Pose T_keyframe_scan = keyframes[k].T_odom_base.inverse() * scan.T_world_body;
    if (k + 1 < keyframes.size() && scan.stamp > keyframes[k].stamp) {
      const Pose T_odometry = keyframes[k].T_odom_base.inverse() * keyframes[k + 1].T_odom_base;
      const Pose T_placed = T_world_keyframe[k].inverse() * T_world_keyframe[k + 1];
      const double share = to_seconds(scan.stamp - keyframes[k].stamp) /
                           to_seconds(keyframes[k + 1].stamp - keyframes[k].stamp);
      T_keyframe_scan = T_keyframe_scan * Pose::exp(share * (T_odometry.inverse() * T_placed).log());
    }
    out.push_back({scan.stamp, T_world_keyframe[k] * T_keyframe_scan});
  }
  return out;
}

}  // namespace adit

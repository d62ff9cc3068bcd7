// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/robot_facts.hpp"

namespace adit {

RobotResult robot_facts(const RobotMap& map, const Trajectory& truth) {
  RobotResult result;
  result.name = map.name;
  // What the robot drove while it recorded; its clock starts before the first whole sweep.
  Trajectory driven;
  for (const StampedPose& scan : map.odometry) {
    if (const Result<Pose> pose = pose_at(truth, scan.stamp)) driven.push_back({scan.stamp, *pose});
  }
  const Trajectory& path = driven.empty() ? map.odometry : driven;
  result.path_length_m = path_length(path);
  result.duration_s = to_seconds(map.odometry.back().stamp - map.odometry.front().stamp);
  result.scans = static_cast<int>(map.odometry.size());
  result.keyframes = static_cast<int>(map.keyframes.size());
  for (const StampedPose& pose : driven) result.route.push_back(pose.T_world_body.translation());
  return result;
}

}  // namespace adit

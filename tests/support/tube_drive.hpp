// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A robot that drove straight through a smooth tube with blocks in it, with exact odometry.
#pragma once

#include <memory>
#include <vector>

#include "adit/robot/robot_map.hpp"
#include "support/synthetic_scan.hpp"

namespace adit::test {

constexpr double kTubeStep = 0.5;  ///< Metres from keyframe to keyframe.

/// A drive of 60 m along x. `scan_at(x, k)` is the scan of keyframe `k`.
template <class ScanAt>
std::shared_ptr<const RobotMap> driven(const ScanAt& scan_at, RobotId robot = {0}) {
  auto map = std::make_shared<RobotMap>();
  map->id = robot;
  map->name = "robot_" + std::to_string(robot.value);
  for (std::uint32_t k = 0; k <= 120; ++k) {
    const double x = kTubeStep * k;
    auto cloud = std::make_shared<const PointCloud>(scan_at(x, k));
    map->places.push_back(describe(*cloud, ScanContextConfig{.max_radius_m = 25.0}));
    map->keyframes.push_back({{robot, k}, {k}, Pose::translation_of(x, 0, 0), std::move(cloud)});
    map->step_covariances.push_back(k == 0 ? Matrix6::Zero() : odometry_covariance({}, kTubeStep));
  }
  return map;
}

/// Each robot has its own noise.
inline std::shared_ptr<const RobotMap> in_a_tube(const std::vector<Box>& boxes, RobotId robot = {0}) {
  Scene scene = smooth_tube();
  scene.boxes = boxes;
  const auto scan_at = [&](double x, std::uint32_t k) {
    Lidar lidar{32, 256, 0.6, 40.0, 0.01};
    lidar.jitter = 0.5;
    lidar.seed = k + 1000U * robot.value;
    return scan_of(scene, lidar, Pose(), {Pose::planar(x, 0.0, 0.0), Vector6::Zero()}, 0).cloud;
  };
  return driven(scan_at, robot);
}

}  // namespace adit::test

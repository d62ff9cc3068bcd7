// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A robot that drove straight through a smooth tube with blocks in it, with exact odometry.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "adit/odometry/path_uncertainty.hpp"
#include "adit/robot/robot_map.hpp"
#include "support/synthetic_scan.hpp"

namespace adit::test {

constexpr double kTubeStep = 0.5;  ///< Metres from keyframe to keyframe.

/// A drive of 60 m along x. Each robot has its own noise.
inline std::shared_ptr<const RobotMap> in_a_tube(const std::vector<Box>& boxes, RobotId robot = {0}) {
  Scene scene = smooth_tube();
  scene.boxes = boxes;
  Lidar lidar{32, 256, 0.6, 40.0, 0.01};
  lidar.jitter = 0.5;
  auto map = std::make_shared<RobotMap>();
  map->id = robot;
  map->name = "robot_" + std::to_string(robot.value);
  for (std::uint32_t k = 0; k <= 120; ++k) {
    const Pose T_odom_base = Pose::translation_of(kTubeStep * k, 0, 0);
    lidar.seed = k + 1000U * robot.value;
    const Scan scan = scan_of(scene, lidar, Pose(), {T_odom_base, Vector6::Zero()}, 0);
    auto cloud = std::make_shared<const PointCloud>(scan.cloud);
    map->places.push_back(describe(*cloud, ScanContextConfig{.max_radius_m = 25.0}));
    map->keyframes.push_back({{robot, k}, {k}, T_odom_base, std::move(cloud)});
    map->step_covariances.push_back(k == 0 ? Matrix6::Zero() : random_walk({}, kTubeStep));
    map->pose_noise.push_back(Matrix6::Zero());
    map->unconfirmed.emplace_back();
  }
  return map;
}

}  // namespace adit::test

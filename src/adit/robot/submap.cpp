// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/submap.hpp"

#include <cmath>

namespace adit {
namespace {

/// The keyframe and those a step or more apart along the path, to both sides.
std::vector<std::size_t> members(const RobotMap& map, std::size_t k, const SubmapConfig& config) {
  std::vector<std::size_t> out{k};
  const auto position = [&](std::size_t i) { return map.keyframes[i].T_odom_base.translation(); };
  for (const std::ptrdiff_t direction : {-1, 1}) {
    double path_m = 0.0;
    double next_m = config.step_m;
    const auto num = std::ssize(map.keyframes);
    for (auto i = static_cast<std::ptrdiff_t>(k) + direction; i >= 0 && i < num; i += direction) {
      const auto here = static_cast<std::size_t>(i);
      path_m += (position(here) - position(static_cast<std::size_t>(i - direction))).norm();
      if (path_m > config.reach_m) break;
      if (path_m < next_m) continue;
      out.push_back(here);
      next_m = path_m + config.step_m;
    }
  }
  return out;
}

}  // namespace

Fields fields_of(SubmapConfig& c) {
  return {{"reach_m", &c.reach_m, "m", 0.0, 100.0,
           "keyframes within this along the path make one cloud; 0: each alone"},
          {"step_m", &c.step_m, "m", 0.1, 100.0, "path between those that are taken"},
          {"radius_m", &c.radius_m, "m", 1.0, 1000.0,
           "points of such a cloud that are farther away are left out"}};
}

PointCloud submap(const RobotMap& map, std::uint32_t k, const SubmapConfig& config) {
  const Keyframe& middle = map.keyframes.at(k);
  PointCloud out;
  if (config.reach_m == 0.0) {
    out.points = middle.cloud->points;
    return out;
  }
  const auto squared_radius = static_cast<float>(config.radius_m * config.radius_m);
  for (const std::size_t i : members(map, k, config)) {
    const Pose T_middle_i = middle.T_odom_base.inverse() * map.keyframes[i].T_odom_base;
    const Eigen::Matrix3f R = T_middle_i.rotation_matrix().cast<float>();
    const Eigen::Vector3f t = T_middle_i.translation().cast<float>();
    for (const Eigen::Vector3f& point : map.keyframes[i].cloud->points) {
      const Eigen::Vector3f p = R * point + t;
      if (p.head<2>().squaredNorm() <= squared_radius) out.points.push_back(p);
    }
  }
  return out;
}

}  // namespace adit

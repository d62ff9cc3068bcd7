// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <cstdio>

#include "adit/core/pose.hpp"
#include "adit/core/version.hpp"
#include "adit/robot/robot_slam.hpp"
#include "adit/simulation/lidar_model.hpp"

int main() {
  const adit::Pose T_world_base = adit::Pose::planar(1.0, 2.0, 0.5);
  const auto lidar = adit::lidar_preset("os2-32");  // from a module with a third party behind it
  if (!lidar) return 1;
  const adit::RobotSlam slam({0}, "consumer", {}, adit::T_base_lidar(*lidar));
  std::printf("adit %s, at (%g, %g), %zu keyframes\n", adit::version().data(), T_world_base.translation().x(),
              T_world_base.translation().y(), slam.map().keyframes.size());
  return slam.map().keyframes.empty() ? 0 : 1;
}

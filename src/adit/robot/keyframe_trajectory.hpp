// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "adit/robot/robot_map.hpp"

namespace adit {

/// The stamps of a robot's keyframes with their poses in a common frame, such as a solution's; one pose per
/// keyframe.
[[nodiscard]] inline Trajectory keyframe_trajectory(const RobotMap& map,
                                                    const std::vector<Pose>& T_world_keyframe) {
  Trajectory trajectory;
  trajectory.reserve(map.keyframes.size());
  for (std::size_t k = 0; k < map.keyframes.size(); ++k)
    trajectory.push_back({map.keyframes[k].stamp, T_world_keyframe.at(k)});
  return trajectory;
}

}  // namespace adit

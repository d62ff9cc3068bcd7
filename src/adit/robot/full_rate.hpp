// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "adit/robot/robot_map.hpp"

namespace adit {

/// T_world_base at every scan, where T_world_keyframe says where the keyframes are (one for each of the map):
/// between two keyframes the odometry, bent evenly so that it meets both; before the first and after the last
/// the odometry from there on. Empty for a map without keyframes.
[[nodiscard]] Trajectory at_every_scan(const RobotMap& map, const std::vector<Pose>& T_world_keyframe);

}  // namespace adit

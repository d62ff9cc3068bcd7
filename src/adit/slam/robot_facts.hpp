// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include "adit/evaluation/study_result.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {

/// What a robot drove, and how many scans and keyframes it made of that; without its odometries. The path is
/// the true one at the stamps of the scans, or that of the odometry where `truth` is empty.
[[nodiscard]] RobotResult robot_facts(const RobotMap& map, const Trajectory& truth);

}  // namespace adit

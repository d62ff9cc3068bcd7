// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include "adit/evaluation/study_result.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {

/// Path, duration, scans and keyframes of one robot; `odometry` of the result stays empty. The path is the
/// true one at the stamps of the scans, or that of the odometry where `truth` is empty.
[[nodiscard]] RobotResult robot_facts(const RobotMap& map, const Trajectory& truth);

}  // namespace adit

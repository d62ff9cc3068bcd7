// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Where there is something to recognise, by the ground truth: without one such place no robot can know that
/// two maps belong together, whatever it does.
#pragma once

#include <vector>

#include "adit/study/robot_run.hpp"

namespace adit {

/// [a][b]: on the stretch that robots a and b share, how many places are like no other in the scans of both.
using DistinctivePlaces = std::vector<std::vector<int>>;

/// Each robot's path is sampled every 10 m. A place is like no other when scans from elsewhere differ from
/// its own by more than noise leaves between two scans of one place, however registration lays one over the
/// other: the twelve scans of all robots that look most like it and were truly taken 15 m away or farther,
/// and those 5 m before and behind on its own path. Measured with `config` under the policy `adaptive`.
Result<DistinctivePlaces> distinctive_places(const std::vector<RobotRun>& runs, const SlamConfig& config);

}  // namespace adit

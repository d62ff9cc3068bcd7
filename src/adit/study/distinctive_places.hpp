// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Counts distinctive places by ground truth. Without one on the shared stretch, no method can know that two
/// maps belong together.
#pragma once

#include <vector>

#include "adit/study/robot_run.hpp"

namespace adit {

/// [a][b]: the number of places on the stretch shared by robots a and b that are distinctive in the scans of
/// both.
using DistinctivePlaces = std::vector<std::vector<int>>;

/// Each robot's path is sampled every 10 m. A place is distinctive when scans from elsewhere, aligned by
/// registration, differ from its own by more than noise leaves between two scans of one place. The scans from
/// elsewhere are the twelve of all robots that look most like it and were truly taken at least 15 m away, and
/// those 5 m ahead and behind on its own path. Measured with `config` under the policy `adaptive`.
Result<DistinctivePlaces> distinctive_places(const std::vector<RobotRun>& runs, const SlamConfig& config);

}  // namespace adit

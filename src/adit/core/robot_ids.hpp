// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "adit/core/ids.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// As many robots as ids fit beside an index into the 64-bit keys of a graph.
inline constexpr std::size_t kMaxRobots =
    std::size_t{std::numeric_limits<decltype(RobotId::value)>::max()} + 1;

/// Ids 0, 1, 2, ... of the robots of a fleet. Fails for more than kMaxRobots: ids would repeat.
[[nodiscard]] Result<std::vector<RobotId>> robot_ids(std::size_t num_robots);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/robot_ids.hpp"

#include "adit/core/format.hpp"

namespace adit {

Result<std::vector<RobotId>> robot_ids(std::size_t num_robots) {
  if (num_robots > kMaxRobots)
    return fail(format("{} recordings, and one fleet has at most {} robots; give fewer at once", num_robots,
                       kMaxRobots));
  std::vector<RobotId> ids;
  for (std::size_t i = 0; i < num_robots; ++i) ids.push_back({static_cast<decltype(RobotId::value)>(i)});
  return ids;
}

}  // namespace adit

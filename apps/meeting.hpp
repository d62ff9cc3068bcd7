// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <vector>

#include "run_config.hpp"

namespace adit::app {

/// The agents of some robots after each has met every other over the loopback bus, and has then heard of what
/// the others' meetings brought.
struct Meeting {
  std::vector<std::shared_ptr<const RobotMap>> maps;
  std::vector<Agent> agents;
  std::vector<std::uint64_t> bytes_sent;  ///< One an agent.
};
Result<Meeting> hold_meeting(std::vector<std::shared_ptr<const RobotMap>> maps, const RunConfig& config);

}  // namespace adit::app

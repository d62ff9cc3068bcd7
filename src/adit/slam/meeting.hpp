// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "adit/slam/slam_config.hpp"

namespace adit {

/// The agents of some robots after each has met every other over the loopback bus and has heard what the
/// others' meetings brought. Unless messages are lost all of them know the same, so any of them can solve.
/// The first has kept its estimate up to date from meeting to meeting, as a robot does while it drives.
struct Meeting {
  std::vector<std::shared_ptr<const RobotMap>> maps;  ///< As given, in that order.
  std::vector<Agent> agents;                          ///< One per map.
  std::vector<std::uint64_t> bytes_sent;              ///< One per agent.
  /// What an agent failed at, and messages and earlier findings that it could not take, one line each.
  std::vector<std::string> failures;
};

/// Robots that met before they were saved, and what all of them had found by then. Those whose test was
/// concluded are not searched again.
struct MetBefore {
  std::vector<RobotId> robots;        ///< Of one earlier session, by their present ids.
  std::vector<MessageBody> findings;  ///< Agent::findings.
};

/// Lets the agents of these maps meet. Robots that have met before exchange what is new, and search nothing
/// again. Without maps the meeting is empty. Fails where the bus does. One phase
/// of progress; may throw `Cancelled` (core/progress.hpp).
[[nodiscard]] Result<Meeting> hold_meeting(std::vector<std::shared_ptr<const RobotMap>> maps,
                                           const SlamConfig& config,
                                           const std::vector<MetBefore>& met_before = {});

}  // namespace adit

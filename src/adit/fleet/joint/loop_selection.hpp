// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Which of the accepted loops take part in the joint solution. What GNC then makes of those is not said
/// here.
#pragma once

#include <cstddef>
#include <map>
#include <utility>
#include <vector>

#include "adit/fleet/joint/fleet_solution.hpp"

namespace adit {

/// Indices into LoopSelection::loops by the robots that they start and end at: of every pair, and of each
/// robot with loops within its own map.
using LoopsOfPairs = std::map<RobotPair, std::vector<std::size_t>>;

/// The loops that may take part, and those of them that do.
struct LoopSelection {
  std::vector<LoopOutcome>
      loops;  ///< The accepted ones between known keyframes; chosen are those is_selected.
  std::vector<PairOutcome> pairs;  ///< Any two robots; with a reason only where their merge is taken back.
  LoopsOfPairs of_pairs;           ///< Selected loops or not; pairs without loops have an empty entry.
};

/// PCM per pair of robots, or, where checks are needed, the loops of the accepted ones but for those that
/// merges with third robots contradict. Loops within one robot take part where an accepted check speaks of
/// them, whatever the pairs need.
[[nodiscard]] LoopSelection select_loops(const FleetGraph& fleet, const BackEndConfig& config);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

namespace adit {

/// What two robots' maps need before they are joined. Set once, in AgentConfig; what an agent knows carries
/// it on (FleetGraph::policy), so that search and solution cannot disagree.
enum class MergePolicy : std::uint8_t {
  adaptive,  ///< A merge check that compared both robots' scans along the claimed overlap and accepted it.
  paper,  ///< Loops that pass the thresholds and PCM, as in the paper: nothing compares the maps. To compare
          ///< with.
};

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "adit/fleet/joint/fleet_solution.hpp"

namespace adit {

/// Why one candidate is in the solution or not.
struct LoopAccount {
  std::optional<std::size_t> hypothesis;  ///< Index in MergeCheck::hypotheses of its pair.
  std::string merge_check;                ///< "accepted", "refused", or "none" where its pair was not tested.
  std::string reason;                     ///< One sentence.
};

/// `outcome` is an entry of `solution.loops`, or a candidate that is not among them with weight 0.
[[nodiscard]] LoopAccount account_of(const LoopOutcome& outcome, const FleetGraph& fleet,
                                     const FleetSolution& solution);

}  // namespace adit

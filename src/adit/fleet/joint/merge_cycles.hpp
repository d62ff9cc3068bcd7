// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Whether the merges of a fleet agree with one another: going around a cycle of robots has to end where it
/// began. What two robots found between themselves is judged here by what they found with others, later and
/// elsewhere.
///
/// How far odometry drifts is known only roughly: floors are not flat, wheels slip. So the miss at the end of
/// a cycle is judged by a likelihood ratio. Where all merges are true it is drift: normal, with the
/// covariance of loops and odometry times a scale that is itself uncertain, which makes it Student's t; the
/// scale is what the loops of each merge show between themselves. Where a merge is wrong it is anything that
/// fits into the map. A cycle contradicts its merges when the second is the likelier.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "adit/fleet/joint/cycle.hpp"

namespace adit {

/// A merge that is to be taken back, and what contradicts it most clearly: a cycle of merges, or pairs of
/// robots whose scans refute where it and others put them.
struct Contradiction {
  std::size_t merge = 0;            ///< Index into the merges.
  std::vector<std::size_t> others;  ///< Merges around the cycle with it; empty: `refuted` speaks.
  std::vector<std::pair<RobotId, RobotId>>
      refuted;            ///< Pairs whose scans refute it; empty: the cycle speaks.
  double miss_m = 0.0;    ///< From the beginning of the cycle to its end,
  double driven_m = 0.0;  ///< after so much odometry.
};

/// Merges to take back, in that order, so that those that are left contradict one another nowhere. The one
/// goes that leaves the fewest contradictions, and of several the one with the least evidence. Tested are all
/// triangles of robots, and the shortest cycle of a merge that is part of none; a merge in no cycle stays.
///
/// `refuted`: hypotheses about pairs that did not merge, which their scans refuted. Merges that together
/// claim the same are contradicted, but not by a single pair: a true hypothesis is refuted far more often
/// than a wrong one is accepted. The merge that most pairs contradict goes. `merges`: at most one per pair of
/// robots; they and `refuted` with loops whose information is positive definite; `chains`: of their robots.
[[nodiscard]] std::vector<Contradiction> contradictions(const std::vector<Merge>& merges,
                                                        const std::vector<Merge>& refuted,
                                                        const Chains& chains, const CycleConfig& config = {});

}  // namespace adit

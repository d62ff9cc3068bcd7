// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What several pairs of robots say together. Robots that share a map lay a third one over it from several
/// sides; each pair alone may have too little to go by, and all together enough.
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "adit/fleet/joint/fleet_solution.hpp"
#include "adit/fleet/joint/merge_cycles.hpp"

namespace adit {

/// The hypothesis with those of its loops that are known, as are their keyframes.
[[nodiscard]] Merge merge_of(const FleetGraph& fleet, const MergeCheck& check,
                             const MergeHypothesis& hypothesis);

/// Hypotheses of several pairs that say the same about two groups of robots.
struct JointMerge {
  std::vector<Merge> merges;  ///< At least two, each with the evidence that its own test gave it.
  double evidence = 0.0;
  double needed = 0.0;
};

/// Groups of robots that `merges` join are joined to one another where hypotheses that no test refuted agree
/// around all cycles and have together the evidence that one pair would need, and no others are as likely;
/// the likeliest two groups first, until none are left. The evidence is that of MergeCheck: of every place,
/// once, however many pairs have compared it, and of walls, less where places are shared. To it comes the
/// logarithm of the share that speaks for this alignment of all cycles of two loops that close. A hypothesis
/// that says the same and was refuted keeps them apart. Pairs whose test accepted a hypothesis are not asked
/// again: that one is among `merges`, or was taken back.
[[nodiscard]] std::vector<JointMerge> joint_merges(const FleetGraph& fleet, std::vector<Merge> merges,
                                                   const Chains& chains, const BackEndConfig& config);

}  // namespace adit

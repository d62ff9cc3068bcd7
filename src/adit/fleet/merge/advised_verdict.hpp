// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The last word of a merge check between two robots: its verdict, with where to drive if that would decide
/// what the verdict leaves open.
#pragma once

#include "adit/fleet/merge/discernment.hpp"
#include "adit/fleet/merge/merge_checker.hpp"
#include "adit/fleet/search/candidate_search.hpp"
#include "adit/fleet/sync/fleet_graph.hpp"

namespace adit {

/// What the robot that decides knows; all of it must outlive this.
struct Advisor {
  const FleetGraph& known;   ///< Both robots are in it.
  CandidateSearch& search;   ///< On its own map.
  Discernment& discernment;  ///< Of its own map.
  double spacing_m = 0.0;    ///< MergeCheckConfig::spacing_m.
};

/// The verdict of `checker`, which is over, about `robots` (own, peer). A refusal that more evidence
/// would decide (MergeChecker::undecided), or whose kind is `no_loop` or `other_tunnel`, ends with where the
/// peer should drive, by `where_to_drive` or `where_to_be_recognised`, or says that no such place was found.
/// Others keep what would help anywhere.
[[nodiscard]] MergeCheck advised_verdict(const MergeChecker& checker, RobotPair robots,
                                         const Advisor& advisor);

}  // namespace adit

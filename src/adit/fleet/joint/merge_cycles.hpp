// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Whether the merges of a fleet agree with one another: going from robot to robot along their loops and
/// odometries and back to the first has to end where it began. What two robots found between themselves is
/// judged here by what they found with others, later and elsewhere.
///
/// How far odometry drifts is known only roughly: floors are not flat, wheels slip. So what is missing at the
/// end of a cycle is judged by the ratio of two likelihoods. Where all merges are true it is drift: normal,
/// with the covariance of loops and odometry times a scale that is itself uncertain, which makes it Student's
/// t; the scale is what the loops of each merge show between themselves. Where a merge is wrong it is
/// anything that fits into the map. A cycle contradicts its merges when the second is the likelier.
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "adit/core/ids.hpp"
#include "adit/posegraph/pcm.hpp"

namespace adit {

/// The loops that join the maps of two robots; PcmLoop::a is a keyframe of robot a, b one of robot b.
struct Merge {
  RobotId a, b;
  double evidence = 0.0;  ///< As MergeCheck's.
  std::vector<PcmLoop> loops;
};

/// A merge that is to be taken back, and what contradicts it most clearly: a cycle of merges, or pairs of
/// robots that other merges put, with it, where their own scans refuted that they are.
struct Contradiction {
  std::size_t merge = 0;                             ///< Index,
  std::vector<std::size_t> others;                   ///< and those of the others around the cycle,
  std::vector<std::pair<RobotId, RobotId>> refuted;  ///< or the pairs.
  double miss_m = 0.0;                               ///< How far from its beginning the cycle ends,
  double driven_m = 0.0;                             ///< after so much odometry.
};

/// Until the merges that are left contradict one another nowhere, the one goes that leaves the fewest
/// contradictions, and of several the one with the least evidence. Tested are all triangles, and of a merge
/// that is part of none the shortest cycle; a merge in no cycle stays. Of the ways around a cycle that drive
/// little the one that closes best counts, so that one bad loop condemns no merge.
///
/// `refuted` are hypotheses about pairs that did not merge, which their scans refuted. Merges that together
/// say the same are contradicted, but not by a single one: a true hypothesis is refuted at about a hundred
/// times the rate at which a wrong one is accepted, so that two pairs are needed. The merge that most of them
/// speak against goes. `merges`: at most one a pair of robots; they and `refuted` with loops whose
/// information is regular; `chains`: of their robots.
[[nodiscard]] std::vector<Contradiction> contradictions(const std::vector<Merge>& merges,
                                                        const std::vector<Merge>& refuted,
                                                        const std::map<RobotId, OdometryChain>& chains);

/// Whether hypotheses about other pairs agree with one another, given the merges that stand.
class CycleCheck {
 public:
  /// Both must outlive it.
  CycleCheck(const std::vector<Merge>& merges, const std::map<RobotId, OdometryChain>& chains);
  ~CycleCheck();
  CycleCheck(const CycleCheck&) = delete;
  CycleCheck& operator=(const CycleCheck&) = delete;

  /// `one` and `other` are about two pairs of robots, each from one of two groups that merges join: along
  /// both and through the groups a cycle ends within three metres of where it began, and does not contradict
  /// its merges.
  [[nodiscard]] bool say_the_same(const Merge& one, const Merge& other) const;

 private:
  struct Known;
  std::unique_ptr<const Known> known_;
};

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/loop_check.hpp"

#include <utility>

#include "adit/fleet/search/revisits.hpp"
#include "adit/fleet/sync/fleet_graph.hpp"

namespace adit {

std::vector<LoopClosure> accepted_without_sliding(std::vector<LoopClosure> loops) {
  std::erase_if(loops, [](const LoopClosure& loop) {
    return loop.verdict != LoopVerdict::accepted || loop.is_free_to_slide();
  });
  return loops;
}

MergeChecker merge_checker_of(const std::vector<LoopClosure>& loops, const OdometryChain& own,
                              const OdometryChain& theirs, Discernment& discernment,
                              const AdaptiveConfig& config, const MergeCheck* earlier) {
  LoopsBetween between{own, theirs, {}, {}, earlier};
  for (const LoopClosure& loop : loops) {
    between.loops.push_back(pcm_loop_of(loop));
    if (loop.from.robot == loop.to.robot)
      between.known_before.push_back(odometry_evidence(own, between.loops.back(), config.search.revisit));
  }
  OwnMeasurements measurements;
  if (!loops.empty()) {  // without one nothing is compared
    measurements.reach_m = discernment.reach_m();
    measurements.measured = [&discernment]() -> const Measured& { return discernment.measured(); };
  }
  return {std::move(between), std::move(measurements), config};
}

}  // namespace adit

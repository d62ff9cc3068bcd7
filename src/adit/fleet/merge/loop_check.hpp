// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The merge check of loops that were registered.
#pragma once

#include <vector>

#include "adit/fleet/merge/adaptive_config.hpp"
#include "adit/fleet/merge/discernment.hpp"
#include "adit/fleet/merge/merge_checker.hpp"
#include "adit/fleet/sync/protocol.hpp"

namespace adit {

/// Accepted loops that registration does not leave free to slide: in tunnels of equal blocks the others would
/// let false alignments pass (decision 0059).
[[nodiscard]] std::vector<LoopClosure> accepted_without_sliding(std::vector<LoopClosure> loops);

/// Begins the check of `loops`, from keyframes of `own` to those of `theirs`; for revisits both are the same
/// chain, and odometry is evidence as well. `discernment`: of the own map; it must outlive the checker.
/// `earlier`: the last check of these robots, if any.
[[nodiscard]] MergeChecker merge_checker_of(const std::vector<LoopClosure>& loops, const OdometryChain& own,
                                            const OdometryChain& theirs, Discernment& discernment,
                                            const AdaptiveConfig& config,
                                            const MergeCheck* earlier = nullptr);

}  // namespace adit

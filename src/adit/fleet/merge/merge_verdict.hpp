// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What a merge check tells all robots.
#pragma once

#include <string>

#include "adit/fleet/merge/merge_decision.hpp"
#include "adit/fleet/sync/protocol.hpp"

namespace adit {

/// What has been found, about the robots `a` (own) and `b`. The reason of a refusal ends with `remedy`, half
/// a sentence, or where that is empty with what would help anywhere.
[[nodiscard]] MergeCheck verdict_of(const MergeJudgement& judgement, RobotId a, RobotId b,
                                    const std::string& remedy);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What kind of difference kept maps apart (RefusalKind), and what more evidence would decide. All rules are
/// here; docs/decisions/0042 tells why.
#pragma once

#include <optional>

#include "adit/core/refusal_kind.hpp"
#include "adit/fleet/merge/merge_advice.hpp"
#include "adit/fleet/merge/merge_decision.hpp"

namespace adit {

/// Unknown where maps are joined.
[[nodiscard]] RefusalKind kind_of_refusal(const MergeJudgement& judgement);

/// How much longer its stretch would have to be, without a change, for the changes seen to be as usual;
/// metres.
[[nodiscard]] double metres_for_changes(const WeighedHypotheses& hypotheses, const Hypothesis& hypothesis);

/// What more evidence would decide; none where maps are joined, nothing aligns them or could be compared, or
/// another tunnel or a sensor is taken to be the reason. Valid as long as the hypotheses of the judgement.
[[nodiscard]] std::optional<UndecidedStretch> undecided_stretch(const MergeJudgement& judgement);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The sentence that a merge check ends with: why maps are joined or not, and what would lead to a merge.
#pragma once

#include <string>

#include "adit/fleet/merge/merge_decision.hpp"

namespace adit {

/// Why, without a full stop.
[[nodiscard]] std::string why_in_words(const MergeJudgement& judgement);
/// What would help anywhere, where maps are not joined: half a sentence.
[[nodiscard]] std::string remedy_in_words(const MergeJudgement& judgement);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Whether maps are joined, by what has been compared so far. docs/decisions/0010 tells why.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "adit/fleet/merge/weighed_hypotheses.hpp"

namespace adit {

/// Why maps are joined or not.
enum class MergeDecision : std::uint8_t {
  no_loops,             ///< No loop aligns the maps.
  nothing_compared,     ///< No keyframes of both stand side by side along the stretch that loops align.
  scans_differ,         ///< At more places than a true alignment leaves.
  nothing_distinctive,  ///< All places that agree would agree if displaced along the tunnel, too.
  other_walls,          ///< The evidence would do if the relief of the walls did not speak against it.
  too_little_evidence,  ///< Less than needed, although some places are distinctive.
  rival,                ///< Another hypothesis has nearly as much evidence.
  unfinished,           ///< Not all places were compared.
  accepted,             ///< Every test was passed.
};

/// The best hypothesis, then the others by how near they are to being its rival; refuted ones last.
[[nodiscard]] std::vector<std::size_t> best_first(const WeighedHypotheses& hypotheses);

/// Why maps are joined or not, if nothing more were compared. `order`: that of `best_first`.
[[nodiscard]] MergeDecision decide(const WeighedHypotheses& hypotheses,
                                   const std::vector<std::size_t>& order);

/// What the hypotheses of a merge check come to.
struct MergeJudgement {
  const WeighedHypotheses& hypotheses;               ///< Must outlive this.
  std::vector<std::size_t> order;                    ///< Of `best_first`.
  MergeDecision decision = MergeDecision::no_loops;  ///< Of `decide`.
  /// There is one unless no loop aligns the maps.
  [[nodiscard]] const Hypothesis& best() const { return hypotheses[order.front()]; }
};
/// As of now.
[[nodiscard]] MergeJudgement judgement_of(const WeighedHypotheses& hypotheses);

}  // namespace adit

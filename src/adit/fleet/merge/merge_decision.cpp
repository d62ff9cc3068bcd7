// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/merge_decision.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace adit {

/// The first of these that holds of the best hypothesis; decision 0010 in this order.
MergeDecision decide(const WeighedHypotheses& hypotheses, const std::vector<std::size_t>& order) {
  if (order.empty()) return MergeDecision::no_loops;
  const Hypothesis& best = hypotheses[order.front()];

  // Against copies. Scans of one place seldom differ.
  if (hypotheses.differs_too_often(best)) return MergeDecision::scans_differ;
  // What was known before is no reason to do without any comparison.
  if (best.compared.empty()) return MergeDecision::nothing_compared;

  // Against chance. Only places where a displacement along the tunnel would show are evidence, by how seldom
  // look-alikes of the own map agree for as long (Wald's test).
  const double evidence = hypotheses.evidence(best);
  if (!(evidence >= hypotheses.needed())) {  // NaN refuses, here and among rivals
    if (evidence - hypotheses.evidence_of_walls(best) >= hypotheses.needed())
      return MergeDecision::other_walls;
    return best.num_distinctive() == 0 ? MergeDecision::nothing_distinctive
                                       : MergeDecision::too_little_evidence;
  }

  // Against every other hypothesis: the nearest one is the second.
  if (order.size() > 1 && hypotheses.are_rivals(best, hypotheses[order[1]])) return MergeDecision::rival;
  return best.is_finished() ? MergeDecision::accepted : MergeDecision::unfinished;
}

std::vector<std::size_t> best_first(const WeighedHypotheses& hypotheses) {
  std::vector<std::size_t> order;
  std::vector<std::size_t> differing;
  const std::size_t num = hypotheses.all().size();
  for (std::size_t h = 0; h < num; ++h)
    (hypotheses.differs_too_often(hypotheses[h]) ? differing : order).push_back(h);
  if (order.size() > 1) {  // the own map is not measured to rank a single one
    std::vector<double> evidence_of(num, 0.0);
    // NaN, which has no place in an order, comes first, where it refuses.
    const auto has_more = [&](std::size_t one, std::size_t other) {
      const bool is_nan = std::isnan(evidence_of[one]);
      const bool other_is = std::isnan(evidence_of[other]);
      return is_nan || other_is ? is_nan && !other_is : evidence_of[one] > evidence_of[other];
    };
    for (const std::size_t h : order) evidence_of[h] = hypotheses.evidence(hypotheses[h]);
    std::ranges::stable_sort(order, has_more);
    for (const std::size_t h : order) evidence_of[h] = hypotheses.evidence_among_rivals(hypotheses[h]);
    std::stable_sort(order.begin() + 1, order.end(), has_more);
  }
  order.insert(order.end(), differing.begin(), differing.end());
  return order;
}

MergeJudgement judgement_of(const WeighedHypotheses& hypotheses) {
  std::vector<std::size_t> order = best_first(hypotheses);
  const MergeDecision decision = decide(hypotheses, order);
  return {hypotheses, std::move(order), decision};
}

}  // namespace adit

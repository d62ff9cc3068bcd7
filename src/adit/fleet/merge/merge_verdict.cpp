// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/merge_verdict.hpp"

#include <algorithm>
#include <span>

#include "adit/fleet/merge/merge_reason.hpp"
#include "adit/fleet/merge/merge_refusal.hpp"
#include "adit/fleet/merge/scan_quality.hpp"

namespace adit {
namespace {

HypothesisCounts counts_of(const WeighedHypotheses& hypotheses, const Hypothesis& h) {
  const EqualSignShare& walls = h.offsets.counted();
  return {static_cast<std::uint32_t>(h.num_distinctive()),
          static_cast<std::uint32_t>(h.num_changes_unless_explained()),
          static_cast<std::uint32_t>(h.things.num()),
          static_cast<std::uint32_t>(walls.num_patches),
          1000.0 * hypotheses.compared_km(h),
          walls.share,
          walls.sigma};
}

MergeHypothesis described(const WeighedHypotheses& hypotheses, std::size_t which, std::size_t best) {
  const Hypothesis& h = hypotheses[which];
  MergeHypothesis out;
  out.num_checked = static_cast<std::uint32_t>(h.compared.size());
  out.num_passed = static_cast<std::uint32_t>(h.num_agreeing());
  out.from_best_m = hypotheses.apart_m(which, best);
  out.counts = counts_of(hypotheses, h);
  for (const std::size_t l : h.loops) {
    const PcmLoop& loop = hypotheses.loops()[l];
    out.loops.emplace_back(static_cast<std::uint32_t>(loop.a), static_cast<std::uint32_t>(loop.b));
  }
  if (hypotheses.differs_too_often(h)) return out;
  out.evidence = hypotheses.evidence(h);
  out.places = h.places();
  out.walls = hypotheses.evidence_of_walls(h);
  out.outcome = which == best                                ? HypothesisOutcome::unsure
                : hypotheses.are_rivals(hypotheses[best], h) ? HypothesisOutcome::rival
                                                             : HypothesisOutcome::behind;
  return out;
}

}  // namespace

MergeCheck verdict_of(const MergeJudgement& judgement, RobotId a, RobotId b, const std::string& remedy) {
  const auto& [hypotheses, order, decision] = judgement;
  MergeCheck out;
  out.a = a;
  out.b = b;
  out.needed = hypotheses.needed();
  out.accepted = decision == MergeDecision::accepted;
  out.refused_kind = kind_of_refusal(judgement);
  if (!order.empty()) out.unconfirmed = judgement.best().unconfirmed();
  out.reason = why_in_words(judgement) + what_dust_may_have_done(out.refused_kind, out.unconfirmed);
  if (!out.accepted) out.reason += "; " + (remedy.empty() ? remedy_in_words(judgement) : remedy);
  if (order.empty()) return out;
  for (const std::size_t h : std::span(order).first(std::min(order.size(), kHypothesesPerCheck)))
    out.hypotheses.push_back(described(hypotheses, h, order.front()));
  MergeHypothesis& best = out.hypotheses.front();
  if (best.outcome != HypothesisOutcome::refuted) {
    const bool has_rival = out.hypotheses.size() > 1 && out.hypotheses[1].outcome == HypothesisOutcome::rival;
    if (out.accepted) best.outcome = HypothesisOutcome::accepted;
    if (has_rival && best.evidence >= out.needed) best.outcome = HypothesisOutcome::rival;
  }
  out.evidence = best.evidence;
  out.num_checked = best.num_checked;
  out.num_passed = best.num_passed;
  out.loops = best.loops;
  return out;
}

}  // namespace adit

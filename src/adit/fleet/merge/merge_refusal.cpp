// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/merge_refusal.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "adit/fleet/merge/look_alikes.hpp"
#include "adit/fleet/merge/merge_evidence.hpp"

namespace adit {
namespace {

/// log P(outcomes | one tunnel, as many changes as fit best) - log P(outcomes | look-alikes).
double evidence_of_changes(const std::vector<TestedPlace>& places, const ChancesToGoOn& chances) {
  const auto num_of = [&](PlaceOutcome outcome) {
    return static_cast<double>(std::ranges::count(places, outcome, &TestedPlace::outcome));
  };
  const double differ = num_of(PlaceOutcome::differs);
  const double agree = num_of(PlaceOutcome::distinctive);
  if (differ == 0.0 || agree == 0.0) return 0.0;
  const std::vector<double> at_places = evidence_at_places(places, chances);
  return std::accumulate(at_places.begin(), at_places.end(), 0.0) +
         differ * std::log(differ / (differ + agree) / (1.0 - kFleetEvidence.agreement_if_true)) +
         agree * std::log(agree / (differ + agree) / kFleetEvidence.agreement_if_true);
}

/// A place has changed where what was changed is all that keeps the evidence below what is needed. Where
/// places differ and look-alikes are likelier than one tunnel, it is not just too little.
RefusalKind kind_where_evidence_is_missing(const WeighedHypotheses& hypotheses, const Hypothesis& h) {
  if (evidence_of_changes(h.places(), hypotheses.chances()) >= hypotheses.needed())
    return RefusalKind::changed_place;
  if (h.num_differing() == 0 || hypotheses.evidence(h) >= 0.0) return RefusalKind::too_little;
  return 2 * h.num_differing() > h.compared.size() ? RefusalKind::other_tunnel
                                                   : RefusalKind::changed_or_other;
}

/// Refused for more changes than are usual, so that the rate of changes is taken that fits best, each change
/// counted once. Where that explains the places better than look-alikes by the evidence that a merge needs,
/// the place has changed. Else it is another tunnel if most differ, and in between nobody knows. The own map
/// is measured only where what was believed before leaves the question open.
RefusalKind kind_where_scans_differ(const WeighedHypotheses& hypotheses, const Hypothesis& h) {
  if (2 * h.num_differing() > h.compared.size()) return RefusalKind::other_tunnel;
  const LookAlikes before(hypotheses.config().evidence);
  const std::vector<TestedPlace> places = h.places();
  return evidence_of_changes(places, before.chances()) >= hypotheses.needed() &&
                 evidence_of_changes(places, hypotheses.chances()) >= hypotheses.needed()
             ? RefusalKind::changed_place
             : RefusalKind::changed_or_other;
}

/// Where scans agree at every place, and errors of range explain the larger part of the distance between both
/// robots' walls, what is left may be an error that the model of sensors does not have.
RefusalKind kind_where_walls_differ(const Hypothesis& h) {
  constexpr double kLargerPart = 0.5;
  return h.num_differing() == 0 && h.offsets.share_of_sensors() > kLargerPart ? RefusalKind::sensor
                                                                              : RefusalKind::changed_or_other;
}

}  // namespace

RefusalKind kind_of_refusal(const MergeJudgement& judgement) {
  switch (judgement.decision) {
    case MergeDecision::no_loops:
      return RefusalKind::no_loop;
    case MergeDecision::other_walls:
      return kind_where_walls_differ(judgement.best());
    case MergeDecision::scans_differ:
      return kind_where_scans_differ(judgement.hypotheses, judgement.best());
    case MergeDecision::too_little_evidence:
      return kind_where_evidence_is_missing(judgement.hypotheses, judgement.best());
    case MergeDecision::rival:
      return RefusalKind::rival;
    case MergeDecision::nothing_distinctive:
    case MergeDecision::nothing_compared:
    case MergeDecision::unfinished:
      return RefusalKind::too_little;
    case MergeDecision::accepted:
      break;
  }
  return RefusalKind::unknown;
}

double metres_for_changes(const WeighedHypotheses& hypotheses, const Hypothesis& h) {
  constexpr double kFarthestPath = 10'000.0;  // metres: so many changes are none
  double metres = 0.0;
  while (metres < kFarthestPath &&
         hypotheses.are_too_many(h.num_changes(), hypotheses.compared_km(h) + metres / 1000.0))
    metres += hypotheses.config().spacing_m;
  return metres;
}

std::optional<UndecidedStretch> undecided_stretch(const MergeJudgement& judgement) {
  const WeighedHypotheses& hypotheses = judgement.hypotheses;
  const MergeDecision decision = judgement.decision;
  const RefusalKind kind = kind_of_refusal(judgement);
  const bool is_merged = decision == MergeDecision::accepted;
  const bool is_other = kind == RefusalKind::other_tunnel || kind == RefusalKind::sensor;
  const bool has_no_places =
      decision == MergeDecision::no_loops || decision == MergeDecision::nothing_compared;
  if (is_merged || is_other || has_no_places || decision == MergeDecision::unfinished) return {};
  const Hypothesis& best = judgement.best();
  const auto loops_of = [&](const Hypothesis& h) {
    std::vector<PcmLoop> loops;
    for (const std::size_t l : h.loops) loops.push_back(hypotheses.loops()[l]);
    return loops;
  };
  UndecidedStretch out;
  for (const PlannedComparison& place : best.plan) out.shared.push_back(place.own);
  out.places = best.places();
  out.chances = hypotheses.chances();
  out.evidence = [&hypotheses, &best, num = static_cast<double>(out.places.size()),
                  copies = hypotheses.share_of_copies_if_true(best)](const auto& places) {
    return hypotheses.evidence_of_places(places, copies) +
           hypotheses.evidence_of_walls(best, static_cast<double>(places.size()) / num);
  };
  out.loops = loops_of(best);
  out.missing = std::max(hypotheses.needed() - hypotheses.evidence(best), 0.0);
  if (decision == MergeDecision::scans_differ) out.least_m = metres_for_changes(hypotheses, best);
  if (kind == RefusalKind::rival) {
    const Hypothesis& rival = hypotheses[judgement.order[1]];
    out.rival_loops = loops_of(rival);
    out.missing = std::max(hypotheses.least_lead() - hypotheses.lead(best, rival), 0.0);
  }
  return out;
}

}  // namespace adit

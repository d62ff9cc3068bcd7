// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/merge_reason.hpp"

#include <cmath>

#include "adit/core/format.hpp"
#include "adit/fleet/merge/merge_refusal.hpp"

namespace adit {
namespace {

constexpr const char* kUntilItTrulyIs =
    "drive on until one passes where the other has truly been, no such place is known";

std::string what_differs(RefusalKind kind) {
  switch (kind) {
    case RefusalKind::changed_place:
      return "the others speak for one tunnel, which has changed in more places than is usual";
    case RefusalKind::changed_or_other:
      return "whether it has changed or is another tunnel cannot be told";
    default:
      return "tunnels that only look alike";
  }
}

/// What is said of places that agree, where that is not enough.
std::string what_else(RefusalKind kind) {
  if (kind == RefusalKind::too_little) return "";
  return ", " + (kind == RefusalKind::changed_place ? "which speaks for one tunnel that has changed"
                                                    : what_differs(kind));
}

std::string why_walls_differ(const Hypothesis& h, RefusalKind kind) {
  const EqualSignShare& walls = h.offsets.counted();
  return format(
      "the walls differ: of the pairs of scans that saw one of {} patches, {:.0f} % found the other robot's "
      "wall on the same side, where noise alone would leave half: {}",
      walls.num_patches, 100.0 * walls.share,
      kind == RefusalKind::sensor
          ? format("it may be the sensors, all {} places agree and range errors explain {:.0f} % of it",
                   h.compared.size(), 100.0 * h.offsets.share_of_sensors())
          : what_differs(RefusalKind::changed_or_other));
}

/// More of the same stretch, if it goes on as before.
std::string what_is_missing(const WeighedHypotheses& hypotheses, const Hypothesis& h) {
  constexpr double kFarthestDrive = 1000.0;  // metres that it makes sense to ask for
  constexpr double kRounding = 10.0;         // metres
  const double share = static_cast<double>(h.num_distinctive()) / static_cast<double>(h.compared.size());
  std::vector<TestedPlace> places = h.places();
  const double copies = hypotheses.share_of_copies_if_true(h);
  const double wanted =
      hypotheses.evidence_of_places(places, copies) + hypotheses.needed() - hypotheses.evidence(h);
  double drive_m = 0.0;
  while (drive_m <= kFarthestDrive && !(hypotheses.evidence_of_places(places, copies) >= wanted)) {
    places.push_back({0, 0, PlaceOutcome::distinctive});
    drive_m += hypotheses.config().spacing_m / share;
  }
  const double metres = kRounding * std::ceil(drive_m / kRounding);
  if (!(metres <= kFarthestDrive))
    return "tunnels here look alike for too long; drive the same stretch past a junction or a niche";
  return format("drive the same stretch for about another {:.0f} m", metres);
}

}  // namespace

std::string why_in_words(const MergeJudgement& judgement) {
  if (judgement.decision == MergeDecision::no_loops) return "no loop was accepted";
  const WeighedHypotheses& hypotheses = judgement.hypotheses;
  const Hypothesis& h = judgement.best();
  const std::size_t num_agreeing = h.num_agreeing();
  switch (judgement.decision) {
    case MergeDecision::other_walls:
      return why_walls_differ(h, kind_of_refusal(judgement));
    case MergeDecision::scans_differ:
      return format("scans differ at {} of {} places along the stretch that {} loops align: {}",
                    h.num_differing(), h.compared.size(), h.loops.size(),
                    what_differs(kind_of_refusal(judgement)));
    case MergeDecision::nothing_distinctive:
      return format(
          "shared stretch has no along-axis constraint: {} places agree, none of which would show a "
          "displacement",
          num_agreeing);
    case MergeDecision::too_little_evidence:
      return format("evidence {:.1f} of {:.1f}: {} of {} places agree, {} of them distinctive{}",
                    hypotheses.evidence(h), hypotheses.needed(), num_agreeing, h.compared.size(),
                    h.num_distinctive(), what_else(kind_of_refusal(judgement)));
    case MergeDecision::nothing_compared:
      return format(
          "nothing was compared: along the stretch that {} loops align no keyframes of both stand "
          "side by side",
          h.loops.size());
    case MergeDecision::rival:
      return format(
          "two hypotheses {:.0f} m apart along the tunnel have similar support, evidence {:.1f} and {:.1f}",
          hypotheses.apart_m(judgement.order[0], judgement.order[1]), hypotheses.evidence_among_rivals(h),
          hypotheses.evidence_among_rivals(hypotheses[judgement.order[1]]));
    case MergeDecision::no_loops:
    case MergeDecision::unfinished:
    case MergeDecision::accepted:
      break;
  }
  return format(
      "{} of {} places along the shared stretch agree, {} of them distinctive: evidence {:.1f}, needed "
      "{:.1f}",
      num_agreeing, h.compared.size(), h.num_distinctive(), hypotheses.evidence(h), hypotheses.needed());
}

std::string remedy_in_words(const MergeJudgement& judgement) {
  switch (judgement.decision) {
    case MergeDecision::no_loops:
      return "drive on until both robots have passed the same place, none is known yet";
    case MergeDecision::other_walls:
      if (kind_of_refusal(judgement) == RefusalKind::sensor)
        return "calibrate the ranges of both sensors: driving on does not tell";
      return what_is_missing(judgement.hypotheses, judgement.best());
    case MergeDecision::scans_differ:
      return kind_of_refusal(judgement) == RefusalKind::other_tunnel
                 ? kUntilItTrulyIs
                 : format("{:.0f} m more of the same stretch without a change would tell",
                          metres_for_changes(judgement.hypotheses, judgement.best()));
    case MergeDecision::nothing_distinctive:
      return "drive on until both pass a junction or a niche";
    case MergeDecision::too_little_evidence:
      return kind_of_refusal(judgement) == RefusalKind::other_tunnel
                 ? kUntilItTrulyIs
                 : what_is_missing(judgement.hypotheses, judgement.best());
    case MergeDecision::rival:
      return "drive on until both pass something that only one of them explains";
    case MergeDecision::nothing_compared:
      return "drive where the other robot has driven, not beside it";
    case MergeDecision::unfinished:
    case MergeDecision::accepted:
      break;
  }
  return "not all places were compared, the robots have to meet again";
}

}  // namespace adit

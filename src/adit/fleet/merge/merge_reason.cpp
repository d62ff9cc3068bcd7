// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The sentence that a merge check ends with: why maps are joined or not, and what would lead to a merge.
#include <cmath>

#include "adit/core/format.hpp"
#include "adit/fleet/merge/merge_checker.hpp"
#include "adit/fleet/merge/merge_evidence.hpp"

namespace adit {

std::string MergeChecker::what_is_missing(const Hypothesis& h) const {
  constexpr double kFarthest = 1000.0;  // metres that it makes sense to ask for
  constexpr double kRounding = 10.0;    // metres
  const std::size_t num_distinctive = h.num_distinctive();
  const double num_places =
      std::ceil((needed() - evidence(h)) / evidence_of_agreement(chances(), num_distinctive));
  const double share = static_cast<double>(num_distinctive) / static_cast<double>(h.compared.size());
  const double metres = kRounding * std::ceil(num_places * config_.spacing_m / share / kRounding);
  if (!(metres <= kFarthest))
    return "tunnels here look alike for too long; drive the same stretch past a junction or a niche";
  return format("drive the same stretch for about another {:.0f} m", metres);
}

std::string MergeChecker::reason(MergeDecision decision, const std::vector<std::size_t>& best_first) const {
  if (decision == MergeDecision::no_loops)
    return "no loop was accepted; drive on until both robots have passed the same place";
  const Hypothesis& h = hypotheses_[best_first.front()];
  const std::size_t num_agreeing = h.num_agreeing();
  switch (decision) {
    case MergeDecision::other_walls: {
      const EqualSignShare walls = h.offsets.counted();
      return format(
          "the walls differ: of the pairs of scans that saw one of {} patches, {:.0f} % found the other "
          "robot's wall on the same side, where noise alone would leave half: two tunnels built alike; drive "
          "on until one passes where the other has truly been",
          walls.num_patches, 100.0 * walls.share);
    }
    case MergeDecision::scans_differ:
      return format(
          "scans differ at {} of {} places along the stretch that {} loops align: tunnels that only look "
          "alike; drive on until one passes where the other has truly been",
          h.num_differing(), h.compared.size(), h.loops.size());
    case MergeDecision::nothing_distinctive:
      return format(
          "shared stretch has no along-axis constraint: {} places agree, none of which would show a "
          "displacement; drive on until both pass a junction or a niche",
          num_agreeing);
    case MergeDecision::too_little_evidence:
      return format("evidence {:.1f} of {:.1f}: {} of {} places agree, {} of them distinctive; {}",
                    evidence(h), needed(), num_agreeing, h.compared.size(), h.num_distinctive(),
                    what_is_missing(h));
    case MergeDecision::too_few_loops:
      return format("{} loops agree, {} are needed; drive on along the same stretch", h.loops.size(),
                    config_.min_loops);
    case MergeDecision::rival:
      return format(
          "two hypotheses {:.0f} m apart along the tunnel have similar support, evidence {:.1f} and {:.1f}; "
          "drive on until both pass something that only one of them explains",
          apart_m(best_first[0], best_first[1]), evidence(h), evidence(hypotheses_[best_first[1]]));
    case MergeDecision::no_loops:
    case MergeDecision::unfinished:
    case MergeDecision::accepted:
      break;
  }
  return format(
      "{} of {} places along the shared stretch agree, {} of them distinctive: evidence {:.1f}, needed "
      "{:.1f}",
      num_agreeing, h.compared.size(), h.num_distinctive(), evidence(h), needed());
}

}  // namespace adit

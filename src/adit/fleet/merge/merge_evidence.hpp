// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What the places at which two maps were compared say about one alignment of them.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "adit/fleet/merge/evidence_model.hpp"
#include "adit/fleet/sync/protocol.hpp"

namespace adit {

/// P(the next distinctive place agrees | the alignment is wrong), after 0, 1-2, 3-6, 7-14, ... that agreed.
using ChancesToGoOn = std::array<double, 8>;

/// P(the next distinctive place agrees | look-alikes), after `passed` that agreed; within `least_chance` and
/// `agreement_if_true` of kFleetEvidence.
[[nodiscard]] double chance_to_go_on(const ChancesToGoOn& chances, std::size_t passed);

/// Evidence of one more distinctive place that agrees, after `passed` of them: the logarithm of the
/// likelihood ratio of "the same stretch" to "look-alikes".
[[nodiscard]] double evidence_of_agreement(const ChancesToGoOn& chances, std::size_t passed);

/// Evidence of each place, in the order driven: negative where scans differ, and there look-alikes begin
/// anew; zero where a place agrees and is not distinctive.
[[nodiscard]] std::vector<double> evidence_at_places(const std::vector<TestedPlace>& places,
                                                     const ChancesToGoOn& chances);

/// P(`num_agreed` distinctive places agree and `num_differed` show a change | tunnels built to the same plan)
/// to P(the same | one tunnel). Neither share is known; each is beta distributed, and every place adds to
/// what is known of it (G. Polya's urn, 1923). So evidence grows only with the logarithm of the number of
/// places that agree, as some copies are good, and many changes tell a copy from a tunnel that has changed.
[[nodiscard]] double copied_to_true(std::size_t num_agreed, std::size_t num_differed);

/// The places of one alignment, counted.
struct CountedPlaces {
  double evidence = 0.0;         ///< The sum of `evidence_at_places`: against look-alikes that are no copies.
  std::size_t num_agreed = 0;    ///< Distinctive ones.
  std::size_t num_differed = 0;  ///< Not counted with the agreed ones.
};
/// In the order driven.
[[nodiscard]] CountedPlaces counted_places(const std::vector<TestedPlace>& places,
                                           const ChancesToGoOn& chances);

/// Share of the look-alikes between two maps that were built to the same plan, by `false_ones`, the places of
/// alignments that are known to be false. One that agrees where look-alikes would not is a copy, and where
/// there is one there are more. Beta distributed like the shares above.
[[nodiscard]] double share_of_copies(const std::vector<CountedPlaces>& false_ones);

/// What the evidence of places is worth where `share` of the look-alikes are copies: tunnels built to the
/// same plan agree where look-alikes would not. Walls have to add the rest.
[[nodiscard]] double unless_copied(const CountedPlaces& places, double share);

/// P(`k` or more events, of which `mean` are expected), by Poisson's distribution.
[[nodiscard]] double poisson_tail(std::size_t k, double mean);

}  // namespace adit

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

/// What evidence `of_places` is worth, the sum over all, of which `num_agreed` are distinctive and agree and
/// `num_differed` differ: tunnels built to the same plan agree where look-alikes would not. Walls have to add
/// the rest.
[[nodiscard]] double unless_copied(double of_places, std::size_t num_agreed, std::size_t num_differed);

/// P(`k` or more events, of which `mean` are expected), by Poisson's distribution.
[[nodiscard]] double poisson_tail(std::size_t k, double mean);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What the places at which two maps were compared say about one alignment of them.
#pragma once

#include <cstddef>
#include <vector>

#include "adit/fleet/sync/protocol.hpp"

namespace adit {

/// P(a place shows no change of structure that none before has shown | the alignment is true): one place in 3
/// m. True pairs of the tuning worlds show one at 3 to 6 places in a hundred (doors, blocked, lined or
/// widened tunnels, vehicles that look like walls). Constant, not a setting: the evidence of several robots
/// is added up, so that all have to weigh alike.
inline constexpr double kAgreementIfTrue = 0.95;

/// Look-alikes go on at least this often, however seldom a robot has seen it: places 3 m apart see in part
/// the same.
inline constexpr double kLeastChance = 0.2;

/// P(the next distinctive place agrees | look-alikes), after `passed` that agreed; within kLeastChance and
/// kAgreementIfTrue.
[[nodiscard]] double chance_to_go_on(const ChancesToGoOn& chances, std::size_t passed);

/// Evidence of one more distinctive place that agrees, after `passed` of them: the logarithm of the
/// likelihood ratio of "the same stretch" to "look-alikes".
[[nodiscard]] double evidence_of_agreement(const ChancesToGoOn& chances, std::size_t passed);

/// Evidence of each place, in the order driven: negative where scans differ, and there look-alikes begin
/// anew; zero where a place agrees and is not distinctive.
[[nodiscard]] std::vector<double> evidence_at_places(const std::vector<TestedPlace>& places,
                                                     const ChancesToGoOn& chances);

/// P(a tunnel that looks alike was built to the same plan), and P(one that was goes on to be for one more
/// distinctive place). No site was counted: parallel tubes and standard drifts exist, and long likenesses of
/// all niches and junctions are rare among them.
inline constexpr double kCopied = 0.001;
inline constexpr double kCopyGoesOn = 0.95;
/// What evidence `of_places` is worth, the sum over all, of which `num` are distinctive and agree: tunnels
/// built to the same plan agree wherever the true one does, whatever look-alikes do. Walls or a long stretch
/// have to add the rest.
[[nodiscard]] double unless_copied(double of_places, double num);

/// P(`k` or more events, of which `mean` are expected), by Poisson's distribution.
[[nodiscard]] double poisson_tail(std::size_t k, double mean);

}  // namespace adit

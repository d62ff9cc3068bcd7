// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What the places at which two maps were compared say about one way to lay them over one another.
#pragma once

#include <cstddef>
#include <vector>

#include "adit/fleet/sync/protocol.hpp"

namespace adit {

/// At one more place that tells, after `passed` of them. Never more than where the alignment is true.
[[nodiscard]] double chance_to_go_on(const ChancesToGoOn& chances, std::size_t passed);

/// At one more place that tells: the logarithm of the likelihood ratio of "the same stretch" to "looks
/// alike".
[[nodiscard]] double evidence_of_agreement(const ChancesToGoOn& chances, std::size_t passed);

/// The same of each place, in the order of the way: negative where scans differ, and there look-alikes begin
/// anew; zero where a place does not tell.
[[nodiscard]] std::vector<double> evidence_at_places(const std::vector<TestedPlace>& along_the_way,
                                                     const ChancesToGoOn& chances);

}  // namespace adit

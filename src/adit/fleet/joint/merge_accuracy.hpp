// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "adit/fleet/joint/fleet_solution.hpp"

namespace adit {

/// Measures how well the frame between each two merged robots is known, into `PairOutcome::accuracy`: from
/// the joint covariance of the solution, which is that of the odometry between the loops and of all loops in
/// use. Pairs without a loop of their own in use, and solutions whose covariance cannot be computed, are left
/// without.
void measure_merges(FleetSolution& solution);

/// "known to 0.034 m along, under 0.01 m across and 0.021 m up, 0.05 deg", and what to do where one loop
/// alone holds it. Nothing is stated to be better than a centimetre and a hundredth of a degree.
[[nodiscard]] std::string to_string(const MergeAccuracy& accuracy);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Which robots have driven through the same stretch of tunnel, by the ground truth: what there was to merge.
#pragma once

#include <vector>

#include "adit/core/records.hpp"

namespace adit {

/// Metres of the true path of one robot that lie within `reach_m` of that of the other, whatever the
/// direction and time of either drive; the smaller value of the two robots. Paths are compared in space, so a
/// crossing on another level does not count. A stretch that a robot drove twice counts twice for that robot
/// alone. Empty trajectories share nothing.
[[nodiscard]] double shared_stretch_m(const Trajectory& truth_a, const Trajectory& truth_b,
                                      double reach_m = 4.0);

/// Robots (by index) that a chain of pairs sharing at least `min_shared_m` joins: the maps there can be. Each
/// group ascending, groups by their smallest member. `shared_m[a][b]` for all a and b.
[[nodiscard]] std::vector<std::vector<std::size_t>> groups_sharing(
    const std::vector<std::vector<double>>& shared_m, double min_shared_m);

}  // namespace adit

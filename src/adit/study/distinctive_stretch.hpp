// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Which robots share a stretch of tunnel that any sensor could tell from all others, by geometry and ground
/// truth alone. Without one no method can know that two maps belong together.
#pragma once

#include <vector>

#include "adit/core/records.hpp"
#include "adit/evaluation/merge_result.hpp"
#include "adit/simulation/raycaster.hpp"

namespace adit {

/// [a][b]: metres of the path shared by robots a and b that lie within distinctive stretches; 0 or at least
/// the length of one, kDistinctiveStretch.
using DistinctiveMetres = std::vector<std::vector<double>>;

/// A stretch of 20 m is distinctive when its surface, laid over any other place that a robot passed, in
/// either direction, differs by more than sensors may err (surface_fit.hpp) in more than 0.5 % of the
/// directions that are looked at. Another place is more than 10 m away, where evaluation calls a loop wrong.
/// Stretches begin every 5 m, and are shared where each of their points is within 4 m of the other robot's
/// path. `truths` are T_world_base of each robot, and `world` what never changes,
/// watertight (EdgeRule): rays that slip through are differences.
[[nodiscard]] DistinctiveMetres distinctive_stretches(const Raycaster& world,
                                                      const std::vector<Trajectory>& truths);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Where robots that share no frame yet stand relative to one another, by the loops between them.
#pragma once

#include <map>
#include <vector>

#include "adit/fleet/sync/fleet_graph.hpp"

namespace adit {

/// T_oa_ob: the odometry frame of robot b in that of robot a, averaged over loops from a to b (at least one):
/// chordal mean of the rotations, mean of the positions that they give to b's keyframes.
[[nodiscard]] Pose mean_frame(const FleetGraph& fleet, const std::vector<const LoopClosure*>& loops);

/// Robots that loops link, each group in ascending order, groups by their smallest id. A robot without loops
/// is a group by itself.
[[nodiscard]] std::vector<std::vector<RobotId>> linked_robots(const FleetGraph& fleet,
                                                              const std::vector<const LoopClosure*>& loops);

/// T_anchor_odom of each robot.
using Frames = std::map<RobotId, Pose>;

/// Every robot in the odometry frame of the smallest id that the loops lead to, pairs with most loops first.
[[nodiscard]] Frames common_frames(const FleetGraph& fleet, const std::vector<const LoopClosure*>& loops);

}  // namespace adit

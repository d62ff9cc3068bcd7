// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// LiDARs on joints that move while they measure: a mast that turns, a head that tilts.
#pragma once

#include "adit/core/records.hpp"
#include "adit/io/frame_tracks.hpp"

namespace adit {

/// Moves each point to where a LiDAR that stays at `T_base_lidar` would see it, by the pose of the LiDAR at
/// the point's own time; `T_base_moving` must know the pose at the scan's stamp, which also serves for points
/// of times that it does not know.
void hold_still(Scan& scan, const MovingPose& T_base_moving, const Pose& T_base_lidar);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Where the motion between scans puts the LiDAR on the robot. Numbers alone: slam/doctor.hpp judges them.
#pragma once

#include <cstddef>
#include <limits>

#include "adit/core/records.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// How far the LiDAR's mount is from where the motion between scans puts it, if the wheels are right. One
/// standard deviation each.
struct MountByMotion {
  double yaw_deg = 0.0;        ///< To be added to that of the mount; any angle from -180 to 180 degrees.
  double yaw_sigma_deg = 0.0;  ///< By the residuals, as `ahead_sigma_m`.
  /// To be added to x, after the yaw has turned the mount about the robot's origin: by the side to which the
  /// LiDAR is carried in turns.
  double ahead_m = 0.0;
  double ahead_sigma_m = 0.0;  ///< Infinite on a drive without curves.
  double left_m = 0.0;         ///< The same of y: by how much shorter its way is in turns to the left.
  /// Infinite on a drive without curves to both sides in which scans say how far the robot went.
  double left_sigma_m = std::numeric_limits<double>::infinity();
  std::size_t num_steps = 0;  ///< From scan to scan, where the motion was well measured; 40 or more.
};
/// Registers some 300 scans, half of them where the robot turns most. A step counts where scans and wheels
/// agree about how far it went, whatever its direction: elsewhere the scans did not see the motion, or the
/// wheels slipped. Fails with the reason, which goes on after "mount: ", where there are no wheels, the robot
/// hardly moves, or the scans leave the motion open. A vehicle whose middle of turning is not the base's
/// origin shows as `ahead_m`, too.
[[nodiscard]] Result<MountByMotion> mount_by_motion(const Recording& recording);

}  // namespace adit

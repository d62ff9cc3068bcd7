// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Where the motion between scans puts the LiDAR on the robot. Numbers alone: slam/doctor.hpp judges them.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// From one scan to the next, how wheels and scans have the robot move.
struct MotionStep {
  Eigen::Vector2d by_wheels =
      Eigen::Vector2d::Zero();    ///< Metres, in the base frame at the first of the two.
  double turned_by_wheels = 0.0;  ///< Yaw, radians.
  /// T_base0_base1, in the axes that the mount in use gives the base.
  Pose by_scans;
  Matrix6 covariance = Matrix6::Zero();  ///< Of `by_scans`, right perturbation, [translation; rotation].
  bool is_registered = false;            ///< The scan fitted on those before it.
};
/// Registers some 300 scans, half of them where the robot turns most, without wheels. Fails with the reason
/// where there are no wheels, or too few scans follow one another while they measure.
[[nodiscard]] Result<std::vector<MotionStep>> motion_steps(const Recording& recording);

/// How the axes of the base that a mount states are turned against those in which the robot drives, found
/// without a look at what is around the robot.
struct TiltByMotion {
  Matrix3 R_level_base = Matrix3::Identity();  ///< Turns the former onto the latter, about the sensor.
  double tilt_deg = 0.0;                       ///< Of its vertical axis, 0 to 180.
  std::size_t num_steps = 0;                   ///< From scan to scan, that it was found by; 40 or more.
};
/// A robot drives along its x axis and turns about its z axis: a mount by which it climbs out of its own
/// floor, or turns about an axis that lies down, is wrong. Only steps count that are as long by the scans as
/// by the wheels, whose directions have to agree; where wheels count backward the tilt is the same. What
/// scans state of their certainty is not used, as it is wrong by such a mount: the floor has to confirm the
/// tilt (scan_checks.hpp). None where steps do not tell, and for tilts of less than 30 degrees, which the
/// floor shows better. How the LiDAR is turned about the direction in which the robot drives shows in turns
/// alone.
[[nodiscard]] std::optional<TiltByMotion> tilt_by_motion(const std::vector<MotionStep>& steps);

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
/// A step counts where scans and wheels agree about how far it went, whatever its direction: elsewhere the
/// scans did not see the motion, or the wheels slipped. Fails with the reason, which goes on after "mount: ",
/// where the robot hardly moves, or the scans leave the motion open. A vehicle whose middle of turning is not
/// the base's origin shows as `ahead_m`, too. The mount has to be level: see tilt_by_motion.
[[nodiscard]] Result<MountByMotion> mount_by_motion(const std::vector<MotionStep>& steps);

}  // namespace adit

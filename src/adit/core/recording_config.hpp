// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "adit/core/config.hpp"

namespace adit {

/// As RecordingConfig::imu: do without an IMU.
inline constexpr std::string_view kNoImu = "none";

/// As RecordingConfig::wheel: do without wheels.
inline constexpr std::string_view kNoWheel = "none";

/// How recordings are opened (io/recording_files.hpp).
struct RecordingConfig {
  std::string mount =
      {};  ///< Overrides what a recording says of its mount, see io/mount.hpp. "": as it says.
  std::string points = {};  ///< Topic of the clouds, where a file has several. "": the only one.
  std::string wheel =
      {};  ///< Topic of wheel odometry, where a file has several. "": the only one; "none": do without.
  std::string imu =
      {};  ///< Topic of the IMU, where a file has several. "": the only one; "none": do without.
  std::string imu_mount = {};  ///< As `mount`, of the IMU.
};

[[nodiscard]] inline Fields fields_of(RecordingConfig& c) {
  return {
      {"mount", &c.mount, "m, deg", 0, 0,
       "pose of the LiDAR on the robot, 'x y z' or 'x y z roll pitch yaw'; empty: as each recording says"},
      {"points", &c.points, "", 0, 0,
       "topic of the clouds, where a recording has several; empty: the only one"},
      {"wheel", &c.wheel, "", 0, 0,
       "topic of the wheel odometry, where a recording has several; empty: the only one; none: without "
       "wheels"},
      {"imu", &c.imu, "", 0, 0,
       "topic of the IMU, where a recording has several; empty: the only one; none: without an IMU"},
      {"imu_mount", &c.imu_mount, "m, deg", 0, 0,
       "pose of the IMU on the robot, as 'mount'; empty: as each recording says"}};
}

}  // namespace adit

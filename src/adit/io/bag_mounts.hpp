// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Where the sensors sit on the robot: as the configuration says, or else as the links of a bag (/tf) have
/// it.
#pragma once

#include <optional>
#include <string>

#include "adit/core/recording_config.hpp"
#include "adit/core/records.hpp"
#include "adit/core/result.hpp"
#include "adit/io/frame_tracks.hpp"

namespace adit {

/// How the robot's frame and the LiDAR's are called in the file.
struct FrameNames {
  std::string base;   ///< As the wheel odometry has it; "" without one.
  std::string lidar;  ///< As its clouds have it.
  std::string imu;    ///< As its samples have it; "" without one.
};

/// Sets the mount of the recording's LiDAR and its source. Returns how the LiDAR moves on the robot, if it
/// does; the mount is then that of the links' first time. Unknown is an error, never the identity.
[[nodiscard]] Result<std::optional<MovingPose>> take_lidar_mount(Recording& recording,
                                                                 const FrameTracks& frames,
                                                                 const FrameNames& names,
                                                                 const RecordingConfig& config);

/// The same for its IMU, if it has one, once the LiDAR's mount is known. Unknown, it is taken for the
/// LiDAR's, which is said; an IMU that moves on the robot is left out.
[[nodiscard]] Result<> take_imu_mount(Recording& recording, const FrameTracks& frames,
                                      const FrameNames& names, const RecordingConfig& config);

}  // namespace adit

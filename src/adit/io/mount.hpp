// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The mount of a LiDAR or an IMU, its pose on the robot, as people write it: "x y z" or "x y z roll pitch
/// yaw" in the base frame, metres and degrees, apart by blanks or commas. The rotation is first roll about x,
/// then pitch about y, then yaw about z, all axes of the base, as URDF's rpy: R = Rz(yaw) Ry(pitch) Rx(roll).
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "adit/core/recording_config.hpp"
#include "adit/core/records.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// T_base_lidar: p_base = T_base_lidar * p_lidar. Fails unless there are three or six finite numbers.
Result<Pose> parse_mount(std::string_view text);

/// Reads back as the same pose, translation to the last bit, rotation to 1e-8 rad; three numbers where there
/// is no rotation.
[[nodiscard]] std::string mount_text(const Pose& T_base_lidar);

/// The mount that the configuration gives, none when it leaves it to the recording.
///@{
Result<std::optional<Pose>> mount_of(const RecordingConfig& config);

Result<std::optional<Pose>> imu_mount_of(const RecordingConfig& config);
///@}

/// Puts a mount given by the user into `recording`, in place of what was known or assumed of it.
///@{
void set_mount(Recording& recording, const Pose& T_base_lidar);
void set_imu_mount(Recording& recording, const Pose& T_base_imu);
///@}

/// The source of a mount that the user gave.
inline constexpr std::string_view kMountGiven = "given by the user";

/// The start of an assumption about the mount.
///@{
inline constexpr std::string_view kMountAssumption = "mount: ";
inline constexpr std::string_view kImuMountAssumption = "mount of the IMU: ";
///@}

/// What to do when nothing says where the IMU sits; ends sentences.
inline constexpr std::string_view kImuMountRemedy =
    "give --imu-mount X,Y,Z[,ROLL,PITCH,YAW] (metres and degrees, the IMU's pose on the robot)";

/// What to do when nothing says where the LiDAR sits; ends error messages.
inline constexpr std::string_view kMountRemedy =
    "give --mount X,Y,Z[,ROLL,PITCH,YAW] (metres and degrees, the LiDAR's pose on the robot; 0,0,0 takes the "
    "LiDAR for the robot's body)";

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// One robot's recording as a bag: an MCAP file, a .db3 file, a folder of them, or a .bag of ROS 1 (bag.hpp).
///
/// adit itself writes MCAP (https://mcap.dev/spec, version 0) that ROS 2 tools and Foxglove can open: profile
/// ros2, messages in CDR, zstd chunks, indexed.
///
///     /ROBOT/points          sensor_msgs/msg/PointCloud2   x y z float32, [intensity float32],
///                                                          [t int32, ns from the stamp]
///     /ROBOT/wheel_odometry  nav_msgs/msg/Odometry         T_wheelodom_base
///     /ROBOT/ground_truth    nav_msgs/msg/Odometry         T_world_base
///     /ROBOT/imu             sensor_msgs/msg/Imu           rad/s, m/s^2, in the IMU's frame
///     /tf_static             tf2_msgs/msg/TFMessage        T_base_lidar, T_base_imu
///
/// A metadata record "adit" holds the robot's name, the LiDAR's, the IMU's, and what was assumed when the
/// recording was first read. Stamps are integer nanoseconds throughout.
#pragma once

#include <filesystem>

#include "adit/core/records.hpp"
#include "adit/core/result.hpp"
#include "adit/io/bag.hpp"
#include "adit/io/mcap_output.hpp"
#include "adit/io/mount.hpp"

namespace adit {

/// Opens a recording. Trajectories are read at once, scans when asked for, from any thread. A file that was
/// not finished is read as far as it goes, which `warnings` says.
///
/// Of a bag that adit did not write are taken: the only topic of clouds (PointCloud2, Livox's CustomMsg), or
/// the one that `config.points` names; for the wheels the only Odometry topic that is not ground
/// truth, or the one, of Odometry or TwistStamped, that `config.wheel` names; as ground truth the one that
/// `config.truth` names, or the only one whose name has "truth", "groundtruth" or "gt" as a whole word; and
/// of /tf_static the chain of links from the wheels' frame to the LiDAR's, without wheels from
/// base_footprint, base_link, base or the root. Without such a chain the mount is unknown, an error unless
/// `config.mount` gives it. The IMU is the only Imu topic, or the one that `config.imu` names; without links
/// to it, its mount is taken for the LiDAR's, which `assumptions` says. With `config.topics_under` only
/// topics below that name are looked at, beside /tf_static, and names without a slash at the front count from
/// there. The unit of point times is `config.point_times`, and their field `config.point_time_field`, or what
/// the first scan shows (packed_cloud.hpp); a field that is stated and not there is an error.
[[nodiscard]] Result<Recording> read_recording(const std::filesystem::path& path,
                                               const RecordingConfig& config = {});
/// Of a bag that is open. The recording keeps it to read scans. Errors name no file.
[[nodiscard]] Result<Recording> read_recording(Bag bag, const RecordingConfig& config = {});
/// Of an MCAP file.
[[nodiscard]] Result<Recording> read_recording(ByteSource source, const RecordingConfig& config = {});

}  // namespace adit

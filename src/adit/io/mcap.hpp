// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// One robot's recording as an MCAP file (https://mcap.dev/spec, version 0) that ROS 2 tools and Foxglove can
/// open: profile ros2, messages in CDR, zstd chunks, indexed.
///
///     /ROBOT/points          sensor_msgs/msg/PointCloud2   x y z float32, [intensity float32], [t int32: ns
///     from the stamp] /ROBOT/wheel_odometry  nav_msgs/msg/Odometry         T_wheelodom_base
///     /ROBOT/ground_truth    nav_msgs/msg/Odometry         T_world_base
///     /tf_static             tf2_msgs/msg/TFMessage        T_base_lidar
///
/// A metadata record "adit" holds the robot's and the lidar's name. Stamps are integer nanoseconds
/// throughout.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <ostream>

#include "adit/core/records.hpp"
#include "adit/core/result.hpp"
#include "adit/io/byte_source.hpp"

namespace adit {

/// Writes all of a recording; scans are asked for one after the other. `progress` is called with the number
/// of scans written so far. The file appears whole or not at all. Fails when a scan cannot be read or there
/// is no scan.
Result<> write_recording(const std::filesystem::path& path, const Recording& recording,
                         const std::function<void(std::size_t)>& progress = {});
Result<> write_recording(std::ostream& out, const Recording& recording,
                         const std::function<void(std::size_t)>& progress = {});

/// Opens a recording. Trajectories are read at once, scans when asked for, from any thread. Needs a complete
/// file: one without footer (a recorder that was interrupted) is an error that names the place and counts the
/// readable messages. Not adit's own file: the only PointCloud2 topic and the only Odometry topics are taken
/// (the wheels' is the one whose name has neither "truth" nor "gt" in it); several lidars in one file are an
/// error that lists them.
Result<Recording> read_recording(const std::filesystem::path& path);
Result<Recording> read_recording(ByteSource source);

}  // namespace adit

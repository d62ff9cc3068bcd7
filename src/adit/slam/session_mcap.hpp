// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A session as Foxglove shows it and `ros2 bag play` plays it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/slam/joint_map.hpp"

namespace adit {

/// Writes an MCAP file of ROS 2 messages, and beside it NAME.layout.json for Foxglove. Topics:
/// - /tf (TFMessage): map -> ROBOT/odom -> ROBOT/base_link at every scan. The frames of further shared maps
///   are map_2, map_3 and so on.
/// - /ROBOT/odometry (Odometry): at every scan, in ROBOT/odom, with the covariance of its noise at keyframes
///   and zeros, which stand for unknown, else.
/// - /ROBOT/points (PointCloud2): each keyframe's cloud, in ROBOT/base_link.
/// - /ROBOT/path (Path), /ROBOT/map (PointCloud2, one point a voxel of `voxel_m` metres): in the shared map.
/// - /graph (MarkerArray): loops in use, and loops that were accepted one by one and not used.
/// The last three are written once, with the first stamp of all. Robots keep the stamps of their recordings;
/// with `together` each starts when the first one does. ROBOT is its name as ROS takes it (`ros_names`). Each
/// file appears whole or not at all.
Result<> write_session_mcap(const std::filesystem::path& path, const PlacedSession& session, double voxel_m,
                            bool together);

/// The names of the robots in topics and frames, one each: letters, digits and underscores, no digit first,
/// and no two alike.
[[nodiscard]] std::vector<std::string> ros_names(const PlacedSession& session);

/// A layout for Foxglove that shows what write_session_mcap writes: JSON.
[[nodiscard]] std::string foxglove_layout(const PlacedSession& session);

}  // namespace adit

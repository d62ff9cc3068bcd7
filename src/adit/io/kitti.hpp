// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// KITTI's velodyne .bin: float32 x, y, z, intensity, one after the other, little-endian, nothing else; and
/// what others write with a fifth column, the ring. KITTI's files of poses and of the calibration.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/io/cloud_files.hpp"

namespace adit {

/// The fifth column is there where the size is a multiple of 20 bytes and every fifth number a whole one from
/// 0 to 255; where it is a multiple of 16 bytes as well, only if there are a hundred rows of several rings.
/// Other sizes are those of truncated files: an error that names the last whole point.
Result<CloudFile> read_kitti(std::string_view bytes);

/// Points without intensity get 0.
[[nodiscard]] std::string write_kitti(const PointCloud& cloud);

/// Poses of `write_kitti_poses`' form. Fails on a line that is not twelve finite numbers whose left part is a
/// rotation to 1e-3, which is then made one; the line is named.
[[nodiscard]] Result<std::vector<Pose>> read_kitti_poses(std::string_view text);

/// Where the LiDAR sits on the camera, T_camera_lidar in metres: the line "Tr:" of KITTI's calib.txt. Fails
/// where there is no such line, and where it is no pose.
[[nodiscard]] Result<Pose> read_kitti_calibration(std::string_view text);

/// KITTI's pose file: one line per pose, the upper three rows of T_world_body row by row, without stamps.
[[nodiscard]] std::string write_kitti_poses(const Trajectory& trajectory);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// KITTI's velodyne .bin: float32 x, y, z, intensity, one after the other, little-endian, nothing else; and
/// what others write with a fifth column, a ring or a time, which is not used. Where it is stated, there are
/// three columns, without intensity, or up to eight, of which those behind the fourth are not used. KITTI's
/// files of poses and of the calibration.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/io/cloud_files.hpp"

namespace adit {

/// How many columns each point has in these bytes, 4 or 5. Five where the size is a multiple of 20 bytes, and
/// the fifth number is a ring (whole, from 0 to 255), or a hundred rows have no negative intensity so. Where
/// the size is a multiple of 16 bytes as well, only if a hundred rows have several rings, or some intensity
/// would be negative with four columns.
[[nodiscard]] std::size_t kitti_columns(std::string_view bytes);
/// The same of all files of a folder: the number by which all sizes can be divided, and where both fit, what
/// the first one shows. Files that neither fits are damaged, and left for `read_kitti` to refuse. Fails where
/// some files have whole rows of four columns alone and others of five.
[[nodiscard]] Result<std::size_t> kitti_columns(const std::vector<std::filesystem::path>& files);

/// Whether the files of a folder have whole rows of so many columns, at least one, as stated. Fails, with the
/// first that has not and its size, where several, and more than a quarter, have not. Fewer are damaged, and
/// left for `read_kitti` to refuse.
[[nodiscard]] Result<> check_kitti_columns(const std::vector<std::filesystem::path>& files,
                                           std::size_t columns);

/// `columns`: of each point, 3 to 8, where that is known (throws ContractViolation on any other number); else
/// kitti_columns. Other sizes are those of truncated files: an error that names the last whole point.
Result<CloudFile> read_kitti(std::string_view bytes, std::optional<std::size_t> columns = {});

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

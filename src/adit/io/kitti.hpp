// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// KITTI's velodyne .bin: float32 x, y, z, intensity, one after the other, little-endian, nothing else; and
/// what others write with a fifth column, the ring.
#pragma once

#include <string>
#include <string_view>

#include "adit/core/records.hpp"
#include "adit/io/cloud_files.hpp"

namespace adit {

/// The fifth column is there where the size is a multiple of 20 bytes and every fifth number a whole one from
/// 0 to 255; where it is a multiple of 16 bytes as well, only if there are a hundred rows of several rings.
/// Other sizes are those of truncated files: an error that names the last whole point.
Result<CloudFile> read_kitti(std::string_view bytes);

/// Points without intensity get 0.
[[nodiscard]] std::string write_kitti(const PointCloud& cloud);

/// KITTI's pose file: one line per pose, the upper three rows of T_world_body row by row, without stamps.
[[nodiscard]] std::string write_kitti_poses(const Trajectory& trajectory);

}  // namespace adit

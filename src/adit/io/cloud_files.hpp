// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Point clouds on disk. The format is chosen by the extension, in any case: .pcd, .ply, .bin (KITTI).
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "adit/core/point_cloud.hpp"
#include "adit/core/recording_config.hpp"
#include "adit/core/result.hpp"
#include "adit/io/point_times.hpp"

namespace adit {

/// Formats of clouds.
enum class CloudFormat { pcd, ply, kitti };
/// With its point: ".bin" for KITTI.
[[nodiscard]] std::string_view extension_of(CloudFormat format);

/// What is known of a cloud before it is read; none: as the cloud shows it.
struct CloudReading {
  KnownTimes times = {};                        ///< Of its points.
  std::optional<std::size_t> bin_columns = {};  ///< Of .bin, 3 to 8 (kitti.hpp).
  bool are_columns_stated = false;              ///< Whether `bin_columns` was given by the user.
};
/// What `config` states of clouds. Fails as stated_times does, and where `bin_columns` is neither 0 nor 3
/// to 8.
[[nodiscard]] Result<CloudReading> stated_reading(const RecordingConfig& config);
/// Fails where a .bin cannot be read so: a field of times is named, and its columns have no names.
[[nodiscard]] Result<> check_bin_reading(const CloudReading& known);

/// What a cloud reader found. Points with a NaN or infinite coordinate are left out and counted.
struct CloudFile {
  PointCloud cloud;                 ///< In the frame and unit of the file.
  std::size_t num_skipped_nan = 0;  ///< Points without finite coordinates.
  /// PCD's VIEWPOINT, the pose of the sensor: p_world = viewpoint * p. None for the identity, which is what
  /// writers put there that do not know it, and for formats without one.
  std::optional<Pose> viewpoint;
  PointTimes times = {};  ///< What the file shows of them; the times themselves are in `cloud`.
  std::optional<std::size_t> bin_columns = {};  ///< Of .bin, as known or found.
};

/// Reads a cloud, in the frame and unit of the file. A missing, truncated or empty file, an unknown extension
/// and a cloud without any finite point are errors that name the file and the place.
Result<CloudFile> read_cloud_file(const std::filesystem::path& path, const CloudReading& known = {});

/// The same without the count.
Result<PointCloud> read_cloud(const std::filesystem::path& path);

/// Writes binary PCD, binary little-endian PLY or KITTI .bin by extension. The file appears whole or not at
/// all. Intensities and times are kept (KITTI: intensities only), and `viewpoint` in PCD. An empty cloud is
/// an error: no reader would accept it. PCD and PLY keep `comment`, a line for people, in their header.
Result<> write_cloud(const std::filesystem::path& path, const PointCloud& cloud, const Pose& viewpoint = {},
                     const std::string& comment = "");

}  // namespace adit

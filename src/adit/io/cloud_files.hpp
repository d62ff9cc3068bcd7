// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Point clouds on disk. The format is chosen by the extension, in any case: .pcd, .ply, .bin (KITTI).
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "adit/core/point_cloud.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// Formats of clouds.
enum class CloudFormat { pcd, ply, kitti };
/// With its point: ".bin" for KITTI.
[[nodiscard]] std::string_view extension_of(CloudFormat format);

/// Of the times of points.
enum class TimeUnit : std::uint8_t { seconds, milliseconds, microseconds, nanoseconds };
/// "s", "ms", "us" or "ns".
[[nodiscard]] std::string_view to_string(TimeUnit unit);
/// None for "", as RecordingConfig::point_times has it.
Result<std::optional<TimeUnit>> parse_time_unit(std::string_view text);

/// Whether somebody stated the unit of the times of points, or it was found (packed_cloud.hpp).
enum class UnitSource : std::uint8_t { stated, found };
/// What to say of times that are not in seconds as floats or nanoseconds as integers.
[[nodiscard]] std::string point_times_note(TimeUnit unit, UnitSource source);
/// A warning where the sweep that these times make, in a unit that was stated, is shorter than 1 ms or longer
/// than 1 s. Without times none.
[[nodiscard]] std::optional<std::string> stated_unit_warning(TimeUnit unit, const PointCloud& sweep);

/// What a cloud reader found. Points with a NaN or infinite coordinate are left out and counted.
struct CloudFile {
  PointCloud cloud;                 ///< In the frame and unit of the file.
  std::size_t num_skipped_nan = 0;  ///< Points without finite coordinates.
  /// PCD's VIEWPOINT, the pose of the sensor: p_world = viewpoint * p. None for the identity, which is what
  /// writers put there that do not know it, and for formats without one.
  std::optional<Pose> viewpoint;
  /// Of the times as they are stored: given, or found; none where there are no times or too few to tell.
  std::optional<TimeUnit> time_unit = {};
  bool has_usual_time_unit = true;  ///< Seconds of floats, nanoseconds of integers.
  /// By how many seconds the earliest point is after the scan's stamp, where times are of another clock than
  /// the stamp and count from the earliest point therefore.
  std::optional<double> clock_apart_s = {};
};

/// Reads a cloud, in the frame and unit of the file. A missing, truncated or empty file, an unknown extension
/// and a cloud without any finite point are errors that name the file and the place.
/// `time_unit`: of point times, where it is known (packed_cloud.hpp says how it is found else).
Result<CloudFile> read_cloud_file(const std::filesystem::path& path, std::optional<TimeUnit> time_unit = {});

/// The same without the count.
Result<PointCloud> read_cloud(const std::filesystem::path& path);

/// Writes binary PCD, binary little-endian PLY or KITTI .bin by extension. The file appears whole or not at
/// all. Intensities and times are kept (KITTI: intensities only), and `viewpoint` in PCD. An empty cloud is
/// an error: no reader would accept it. PCD and PLY keep `comment`, a line for people, in their header.
Result<> write_cloud(const std::filesystem::path& path, const PointCloud& cloud, const Pose& viewpoint = {},
                     const std::string& comment = "");

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/cloud_files.hpp"

#include <algorithm>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/kitti.hpp"
#include "adit/io/pcd.hpp"
#include "adit/io/ply.hpp"
#include "adit/io/text.hpp"

namespace adit {
namespace {

Result<CloudFormat> format_of(const std::filesystem::path& path) {
  const std::string extension = lower_case(path.extension().string());
  for (const CloudFormat format : {CloudFormat::pcd, CloudFormat::ply, CloudFormat::kitti})
    if (extension == extension_of(format)) return format;
  return fail(format("{}: '{}' is not an extension of point clouds; .pcd, .ply and .bin are", path.string(),
                     extension));
}

Result<CloudFile> parse(CloudFormat format, std::string_view bytes, std::optional<TimeUnit> time_unit) {
  switch (format) {
    case CloudFormat::pcd:
      return read_pcd(bytes, time_unit);
    case CloudFormat::ply:
      return read_ply(bytes, time_unit);
    case CloudFormat::kitti:
      break;
  }
  return read_kitti(bytes);
}

std::string bytes_of(CloudFormat format, const PointCloud& cloud, const Pose& viewpoint,
                     const std::string& comment) {
  switch (format) {
    case CloudFormat::pcd:
      return write_pcd(cloud, PcdData::binary, viewpoint, comment);
    case CloudFormat::ply:
      return write_ply(cloud, PlyData::binary_little_endian, comment);
    case CloudFormat::kitti:
      break;
  }
  return write_kitti(cloud);
}

}  // namespace

std::string_view to_string(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::seconds:
      return "s";
    case TimeUnit::milliseconds:
      return "ms";
    case TimeUnit::microseconds:
      return "us";
    case TimeUnit::nanoseconds:
      break;
  }
  return "ns";
}

std::string point_times_note(TimeUnit unit, UnitSource source) {
  if (source == UnitSource::stated)
    return format("point times: in {}, as stated by --point-times", to_string(unit));
  return format(
      "point times: in {}, in which a sweep lasts as long as sweeps do; if that is wrong, give "
      "--point-times",
      to_string(unit));
}

std::optional<std::string> stated_unit_warning(TimeUnit unit, const PointCloud& sweep) {
  constexpr std::int64_t kShortest = 1'000'000;  // nanoseconds; LiDARs take 50 to 200 ms
  constexpr std::int64_t kLongest = 1'000'000'000;
  if (!sweep.has_times()) return std::nullopt;
  const auto [first, last] = std::ranges::minmax(sweep.time_offsets_ns);
  const std::int64_t lasts = std::int64_t{last} - first;
  if (lasts >= kShortest && lasts <= kLongest) return std::nullopt;
  return format(
      "point times: in {}, as stated by --point-times, the first sweep lasts {:.3g} s, where LiDARs take "
      "0.05 to 0.2 s; state the unit in which the driver writes them (s, ms, us or ns), or leave the option "
      "out",
      to_string(unit), 1e-9 * static_cast<double>(lasts));
}

Result<std::optional<TimeUnit>> parse_time_unit(std::string_view text) {
  using enum TimeUnit;
  if (text.empty()) return std::optional<TimeUnit>();
  for (const TimeUnit unit : {seconds, milliseconds, microseconds, nanoseconds})
    if (text == to_string(unit)) return std::optional(unit);
  return fail(format("'{}' is not a unit of point times; s, ms, us and ns are", text));
}

std::string_view extension_of(CloudFormat format) {
  switch (format) {
    case CloudFormat::pcd:
      return ".pcd";
    case CloudFormat::ply:
      return ".ply";
    case CloudFormat::kitti:
      break;
  }
  return ".bin";
}

Result<CloudFile> read_cloud_file(const std::filesystem::path& path, std::optional<TimeUnit> time_unit) {
  const Result<CloudFormat> format = format_of(path);
  if (!format) return tl::unexpected(format.error());
  const Result<std::string> bytes = read_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<CloudFile> file = parse(*format, *bytes, time_unit);
  if (!file) return fail(path.string(), file.error());
  return file;
}

Result<PointCloud> read_cloud(const std::filesystem::path& path) {
  return read_cloud_file(path).map([](CloudFile file) { return std::move(file.cloud); });
}

Result<> write_cloud(const std::filesystem::path& path, const PointCloud& cloud, const Pose& viewpoint,
                     const std::string& comment) {
  if (cloud.empty()) return fail(path.string() + ": the cloud has no points; nothing is written");
  return format_of(path).and_then(
      [&](CloudFormat format) { return write_bytes(path, bytes_of(format, cloud, viewpoint, comment)); });
}

}  // namespace adit

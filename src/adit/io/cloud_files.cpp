// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/cloud_files.hpp"

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

Result<CloudFile> parse(CloudFormat format, std::string_view bytes, const CloudReading& known) {
  switch (format) {
    case CloudFormat::pcd:
      return read_pcd(bytes, known.times);
    case CloudFormat::ply:
      return read_ply(bytes, known.times);
    case CloudFormat::kitti:
      break;
  }
  return check_bin_reading(known).and_then([&] { return read_kitti(bytes, known.bin_columns); });
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

Result<CloudReading> stated_reading(const RecordingConfig& config) {
  CloudReading stated;
  stated.are_columns_stated = config.bin_columns != 0;
  if (stated.are_columns_stated) {
    const auto columns = static_cast<std::size_t>(config.bin_columns);  // a negative one becomes too large
    if (columns < kLeastBinColumns || columns > kMostBinColumns)
      return fail(format("recording.bin_columns: {} is not {} to {}, or 0 for as many as are found",
                         config.bin_columns, kLeastBinColumns, kMostBinColumns));
    stated.bin_columns = columns;
  }
  return stated_times(config).map([&](KnownTimes times) {
    stated.times = std::move(times);
    return stated;
  });
}

Result<> check_bin_reading(const CloudReading& known) {
  if (known.times.field.empty()) return {};
  return fail(
      no_stated_field(known.times.field, "the columns of a .bin have no names; leave the option out"));
}

Result<CloudFile> read_cloud_file(const std::filesystem::path& path, const CloudReading& known) {
  const Result<CloudFormat> format = format_of(path);
  if (!format) return tl::unexpected(format.error());
  const Result<std::string> bytes = read_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<CloudFile> file = parse(*format, *bytes, known);
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

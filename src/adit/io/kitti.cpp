// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/kitti.hpp"

#include <bit>
#include <cmath>
#include <system_error>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/packed_cloud.hpp"
#include "adit/io/text.hpp"

namespace adit {

namespace {

constexpr std::size_t kFour = 16;  ///< Bytes of a row of four columns,
constexpr std::size_t kFive = 20;  ///< and of five.

/// The number in a column of rows of so many bytes.
double number_at(std::string_view bytes, std::size_t row_size, std::size_t row, std::size_t column) {
  return load_scalar(ScalarType::float32, bytes.data() + row * row_size + 4 * column, std::endian::little);
}

enum class Rings { none, one, several };

/// What the fifth column holds.
Rings rings_in(std::string_view bytes) {
  Rings rings = Rings::one;
  for (std::size_t row = 0; row < bytes.size() / kFive; ++row) {
    const double ring = number_at(bytes, kFive, row, 4);
    if (!(ring >= 0.0 && ring <= 255.0 && ring == std::floor(ring))) return Rings::none;
    if (ring != number_at(bytes, kFive, 0, 4)) rings = Rings::several;
  }
  return rings;
}

/// Rows of another length put coordinates, which have both signs, where the intensity is.
bool has_negative_intensity(std::string_view bytes, std::size_t row_size) {
  for (std::size_t row = 0; row < bytes.size() / row_size; ++row)
    if (number_at(bytes, row_size, row, 3) < 0.0) return true;
  return false;
}

}  // namespace

std::size_t kitti_columns(std::string_view bytes) {
  constexpr std::size_t kEnough = 100;  // rows
  if (bytes.empty() || bytes.size() % kFive != 0) return 4;
  const bool fits_four = bytes.size() % kFour == 0;
  const bool are_enough = bytes.size() / kFive >= kEnough;
  const Rings rings = rings_in(bytes);
  if (fits_four ? are_enough && rings == Rings::several : rings != Rings::none) return 5;
  if (!are_enough || has_negative_intensity(bytes, kFive)) return 4;
  return !fits_four || has_negative_intensity(bytes, kFour) ? 5 : 4;
}

Result<std::size_t> kitti_columns(const std::vector<std::filesystem::path>& files) {
  std::filesystem::path four;  // the first that fits four columns alone,
  std::filesystem::path five;  // five alone,
  std::filesystem::path both;
  for (const std::filesystem::path& file : files) {
    std::error_code unknown;
    const std::uintmax_t size = std::filesystem::file_size(file, unknown);
    const bool fits_four = size % kFour == 0;
    const bool fits_five = size % kFive == 0;
    if (unknown || size == 0 || (!fits_four && !fits_five)) continue;
    std::filesystem::path& place = fits_four && fits_five ? both : fits_four ? four : five;
    if (place.empty()) place = file;
  }
  if (!four.empty() && !five.empty())
    return fail(format(
        "{} has whole rows of x y z intensity (16 bytes), {} of five columns (20 bytes): keep clouds of "
        "one kind per folder, without those that were cut short",
        four.filename().string(), five.filename().string()));
  if (!five.empty()) return 5;
  if (!four.empty() || both.empty()) return 4;
  return read_bytes(both).map([](const std::string& bytes) { return kitti_columns(bytes); });
}

Result<> check_kitti_columns(const std::vector<std::filesystem::path>& files, std::size_t columns) {
  ADIT_CHECK(columns > 0, "rows have columns");
  const std::size_t row = sizeof(float) * columns;
  std::string first;
  std::size_t num = 0;
  for (const std::filesystem::path& file : files) {
    std::error_code unknown;
    const std::uintmax_t size = std::filesystem::file_size(file, unknown);
    if (unknown || size % row == 0) continue;
    if (num++ == 0) first = format("{}: {} bytes", file.filename().string(), size);
  }
  // Where the number is wrong, every second file at most has whole rows of it; else a few are damaged.
  if (num < 2 || 4 * num <= files.size()) return {};
  return fail(
      format("{} are not a whole number of rows of {} columns ({} bytes each), as --bin-columns "
             "(recording.bin_columns) states, and so it is in {} of {} files; state how many there are, or "
             "leave the option out",
             first, columns, row, num, files.size()));
}

Result<CloudFile> read_kitti(std::string_view bytes, std::optional<std::size_t> columns) {
  const std::size_t num_columns = columns ? *columns : kitti_columns(bytes);
  ADIT_CHECK(num_columns >= kLeastBinColumns && num_columns <= kMostBinColumns, "3 to 8 columns");
  const std::size_t row = sizeof(float) * num_columns;
  if (bytes.size() % row != 0) {
    return fail(
        format("{} bytes are not a whole number of points of {} columns ({} bytes each); the last whole one "
               "ends at byte {}: the file is truncated, not a KITTI file, or has another number of columns "
               "(--bin-columns)",
               bytes.size(), num_columns, row, bytes.size() / row * row));
  }
  PackedCloud packed;
  packed.bytes = bytes;
  packed.num_points = bytes.size() / row;
  packed.x = {ScalarType::float32, 0, row};
  packed.y = {ScalarType::float32, 4, row};
  packed.z = {ScalarType::float32, 8, row};
  if (num_columns > kLeastBinColumns) packed.intensity = {ScalarType::float32, 12, row};
  return unpack_file(packed).map([&](CloudFile file) {
    file.bin_columns = num_columns;
    return file;
  });
}

std::string write_kitti(const PointCloud& cloud) {
  cloud.check();
  PointCloud bare;
  bare.points = cloud.points;
  bare.intensities = cloud.intensities;
  bare.intensities.resize(cloud.size(), 0.0F);
  return packed_rows(bare);
}

namespace {

/// The upper three rows of a transform, row by row.
Result<Pose> pose_of(std::string_view line) {
  constexpr double kNearly = 1e-3;  // files have six digits or more
  std::vector<double> numbers;
  for (const std::string_view word : split_words(line)) {
    const std::optional<double> number = parse_double(word);
    if (!number || !std::isfinite(*number)) return fail(format("'{}' is not a finite number", word));
    numbers.push_back(*number);
  }
  if (numbers.size() != 12)
    return fail(format("{} numbers; a pose has twelve, the upper three rows of its matrix", numbers.size()));
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> rows(numbers.data());
  const Matrix3 R = rows.leftCols<3>();
  if (!(R * R.transpose()).isIdentity(kNearly) || R.determinant() < 0.0)
    return fail("the left part of the matrix is no rotation");
  return Pose(Eigen::Quaterniond(R).normalized(), rows.col(3));
}

}  // namespace

Result<std::vector<Pose>> read_kitti_poses(std::string_view text) {
  std::vector<Pose> poses;
  LineReader lines(text);
  while (lines.next()) {
    if (split_words(lines.line()).empty()) continue;
    const Result<Pose> pose = pose_of(lines.line());
    if (!pose) return fail(format("line {}", lines.number()), pose.error());
    poses.push_back(*pose);
  }
  return poses;
}

Result<Pose> read_kitti_calibration(std::string_view text) {
  constexpr std::string_view kKey = "Tr:";
  LineReader lines(text);
  while (lines.next()) {
    if (!lines.line().starts_with(kKey)) continue;
    const Result<Pose> pose = pose_of(lines.line().substr(kKey.size()));
    if (!pose) return fail(format("line {}", lines.number()), pose.error());
    return pose;
  }
  return fail("has no line 'Tr:', which says where the LiDAR sits on the camera");
}

std::string write_kitti_poses(const Trajectory& trajectory) {
  std::string text;
  for (const StampedPose& pose : trajectory) {
    const Eigen::Matrix4d T = pose.T_world_body.matrix();
    for (Eigen::Index i = 0; i < 12; ++i) text += format("{}{}", T(i / 4, i % 4), i < 11 ? ' ' : '\n');
  }
  return text;
}

}  // namespace adit

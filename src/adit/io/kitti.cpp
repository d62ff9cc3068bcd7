// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/kitti.hpp"

#include <cmath>
#include <optional>

#include "adit/core/format.hpp"
#include "adit/io/packed_cloud.hpp"
#include "adit/io/text.hpp"

namespace adit {

namespace {

constexpr std::size_t kFour = 16;  ///< Bytes of a row of four columns,
constexpr std::size_t kFive = 20;  ///< and of five.

/// Where the size fits four columns, too, it takes many rows of several rings to tell.
bool has_rings(std::string_view bytes) {
  constexpr std::size_t kEnough = 100;  // rows
  if (bytes.empty() || bytes.size() % kFive != 0) return false;
  const auto ring_at = [&](std::size_t row) {
    return load_scalar(ScalarType::float32, bytes.data() + row * kFive + kFour, std::endian::little);
  };
  const std::size_t num = bytes.size() / kFive;
  bool are_several = false;
  for (std::size_t row = 0; row < num; ++row) {
    const double ring = ring_at(row);
    if (!(ring >= 0.0 && ring <= 255.0 && ring == std::floor(ring))) return false;
    are_several |= ring != ring_at(0);
  }
  return bytes.size() % kFour != 0 || (num >= kEnough && are_several);
}

}  // namespace

Result<CloudFile> read_kitti(std::string_view bytes) {
  const std::size_t row = has_rings(bytes) ? kFive : kFour;
  if (bytes.size() % row != 0) {
    return fail(
        format("{} bytes are not a whole number of points (x y z intensity, 16 bytes each, or 20 with the "
               "ring); the last whole one "
               "ends at byte {}: the file is truncated or not a KITTI file",
               bytes.size(), bytes.size() / row * row));
  }
  PackedCloud packed;
  packed.bytes = bytes;
  packed.num_points = bytes.size() / row;
  packed.x = {ScalarType::float32, 0, row};
  packed.y = {ScalarType::float32, 4, row};
  packed.z = {ScalarType::float32, 8, row};
  packed.intensity = {ScalarType::float32, 12, row};
  return unpack_file(packed);
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

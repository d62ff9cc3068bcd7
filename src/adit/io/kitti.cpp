// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/kitti.hpp"

#include "adit/core/format.hpp"
#include "adit/io/packed_cloud.hpp"

namespace adit {

Result<CloudFile> read_kitti(std::string_view bytes) {
  constexpr std::size_t kRow = 16;
  if (bytes.size() % kRow != 0) {
    return fail(format(
        "{} bytes are not a whole number of points (x y z intensity, 16 bytes each); the last whole one "
        "ends at byte {}: the file is truncated or not a KITTI file",
        bytes.size(), bytes.size() / kRow * kRow));
  }
  PackedCloud packed;
  packed.bytes = bytes;
  packed.num_points = bytes.size() / kRow;
  packed.x = {ScalarType::float32, 0, kRow};
  packed.y = {ScalarType::float32, 4, kRow};
  packed.z = {ScalarType::float32, 8, kRow};
  packed.intensity = {ScalarType::float32, 12, kRow};
  return unpack(packed);
}

std::string write_kitti(const PointCloud& cloud) {
  cloud.check();
  PointCloud bare;
  bare.points = cloud.points;
  bare.intensities = cloud.intensities;
  bare.intensities.resize(cloud.size(), 0.0F);
  return packed_rows(bare);
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

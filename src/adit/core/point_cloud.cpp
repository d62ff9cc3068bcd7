// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/point_cloud.hpp"

namespace adit {

PointCloud transformed(const Pose& T_a_b, PointCloud cloud_b) {
  const Eigen::Matrix3f R = T_a_b.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_a_b.translation().cast<float>();
  for (Eigen::Vector3f& p : cloud_b.points) p = R * p + t;
  return cloud_b;
}

void append(PointCloud& cloud, const PointCloud& part) {
  const std::size_t before = cloud.size();
  cloud.points.insert(cloud.points.end(), part.points.begin(), part.points.end());
  cloud.time_offsets_ns.clear();
  if (cloud.intensities.empty() && part.intensities.empty()) return;
  cloud.intensities.resize(before);
  cloud.intensities.insert(cloud.intensities.end(), part.intensities.begin(), part.intensities.end());
  cloud.intensities.resize(cloud.size());
}

}  // namespace adit

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

}  // namespace adit

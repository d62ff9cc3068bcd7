// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/preprocess.hpp"

namespace adit {
namespace {

// One pass over the cloud; `move(i, p)` takes point i into the base frame. NaN fails both comparisons.
template <class Move>
PointCloud cropped(const PointCloud& cloud, const RangeLimits& limits, const Move& move) {
  const auto min2 = static_cast<float>(limits.min_range * limits.min_range);
  const auto max2 = static_cast<float>(limits.max_range * limits.max_range);
  PointCloud out;
  out.points.reserve(cloud.size());
  out.intensities.reserve(cloud.intensities.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f& p = cloud.points[i];
    const float range2 = p.squaredNorm();
    if (!(range2 > min2 && range2 < max2)) continue;
    out.points.push_back(move(i, p));
    if (!cloud.intensities.empty()) out.intensities.push_back(cloud.intensities[i]);
  }
  return out;
}

}  // namespace

PointCloud preprocess(const PointCloud& cloud_lidar, const RangeLimits& limits, const Pose& T_base_lidar,
                      const std::optional<ConstantVelocity>& motion) {
  cloud_lidar.check();
  if (motion && cloud_lidar.has_times()) {
    const SweepTransform sweep(*motion, T_base_lidar, cloud_lidar.time_offsets_ns);
    return cropped(cloud_lidar, limits, [&](std::size_t i, const Eigen::Vector3f& p) {
      return sweep.apply(cloud_lidar.time_offsets_ns[i], p);
    });
  }
  const Eigen::Matrix3f R = T_base_lidar.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_base_lidar.translation().cast<float>();
  return cropped(cloud_lidar, limits, [&](std::size_t, const Eigen::Vector3f& p) { return R * p + t; });
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/kinematic_icp.hpp"

#include <cmath>

#include "adit/odometry/preprocess.hpp"

namespace adit {

KinematicIcp::KinematicIcp(const KinematicIcpConfig& config, const Pose& T_base_lidar)
    : config_(config), T_base_lidar_(T_base_lidar), map_(config.voxel_size, config.max_points_per_voxel) {}

OdometryStep KinematicIcp::register_scan(const Scan& scan, const WheelDelta& wheel) {
  const Pose T_last_now = started_ ? wheel.T_base0_base1 : Pose();
  const Pose T_prediction = T_odom_base_ * T_last_now;
  std::optional<ConstantVelocity> motion;
  if (config_.deskew && started_) motion = {T_last_now, wheel.duration};
  preprocess(scan.cloud, {config_.min_range, config_.max_range}, T_base_lidar_, motion, cloud_);
  started_ = true;

  OdometryStep step = is_resting(last_registered_, T_prediction, config_.stationary_motion)
                          ? resting(*last_registered_, T_prediction)
                          : moving(T_prediction);
  step.stamp = scan.stamp;
  T_odom_base_ = step.T_odom_base;
  return step;
}

OdometryStep KinematicIcp::moving(const Pose& T_prediction) {
  const ThinnedScan thin = thinned(cloud_.points, config_.voxel_size, thinner_);
  const OdometryStep step =
      map_.empty() ? first_step(thin, T_prediction, config_) : registered(thin, T_prediction);
  update_map(map_, thin, step, config_);
  last_registered_ = enters_map(step.status) ? std::optional(step) : std::nullopt;
  return step;
}

OdometryStep KinematicIcp::registered(const ThinnedScan& scan, const Pose& T_prediction) {
  // Section III-C: what the spacing of the map and what the wheels leave open.
  const double sigma_map = config_.voxel_size / std::sqrt(config_.max_points_per_voxel);
  const double max_distance = 3.0 * (sigma_map + deviations_.sigma());
  const Alignment alignment = align_unicycle(scan.source, map_, T_prediction, max_distance, config_);
  if (alignment.status == StepStatus::ok)
    deviations_.add(point_deviation(T_prediction.inverse() * alignment.T_map_base, config_.max_range));
  return step_of(alignment, scan.source, map_, max_distance, config_);
}

}  // namespace adit

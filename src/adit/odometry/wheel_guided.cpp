// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/wheel_guided.hpp"

#include "adit/odometry/preprocess.hpp"

namespace adit {

Field stationary_motion_field(double* stationary_motion) {
  return {"stationary_motion",
          stationary_motion,
          "",
          0.0,
          1.0,
          "norm of the wheel motion [m; rad] since the last registered scan up to which none is registered"};
}

WheelGuided::WheelGuided(const ScanToMapConfig& config, double stationary_motion, const Pose& T_base_lidar)
    : config_(config),
      stationary_motion_(stationary_motion),
      T_base_lidar_(T_base_lidar),
      map_(config.voxel_size, config.max_points_per_voxel) {}

OdometryStep WheelGuided::register_scan(const Scan& scan, const WheelDelta& wheel,
                                        const Register& register_with_map) {
  const Pose T_last_now = started_ ? wheel.T_base0_base1 : Pose();
  const Pose T_prediction = T_odom_base_ * T_last_now;
  std::optional<ConstantVelocity> motion;
  if (config_.deskew && started_) motion = {T_last_now, wheel.duration};
  preprocess(scan.cloud, {config_.min_range, config_.max_range}, T_base_lidar_, motion, cloud_);
  started_ = true;

  OdometryStep step =
      is_at_rest(T_prediction) ? resting(T_prediction) : moving(T_prediction, T_last_now, register_with_map);
  step.stamp = scan.stamp;
  T_odom_base_ = step.T_odom_base;
  return step;
}

bool WheelGuided::is_at_rest(const Pose& T_prediction) const {
  return last_registered_ &&
         (last_registered_->T_odom_base.inverse() * T_prediction).log().norm() <= stationary_motion_;
}

OdometryStep WheelGuided::resting(const Pose& T_prediction) const {
  OdometryStep step = *last_registered_;
  step.T_odom_base = T_prediction;
  if (step.status == StepStatus::no_map) step.status = StepStatus::ok;
  step.num_correspondences = 0;
  step.iterations = 0;
  return step;
}

OdometryStep WheelGuided::moving(const Pose& T_prediction, const Pose& T_last_now,
                                 const Register& register_with_map) {
  const ThinnedScan thin = thinned_twice(cloud_.points, config_.voxel_size, thinner_);
  const OdometryStep step = map_.empty() ? first_step(thin, T_prediction, config_)
                                         : register_with_map(thin, T_prediction, T_last_now);
  update_map(map_, thin, step, config_);
  last_registered_ = enters_map(step.status) ? std::optional(step) : std::nullopt;
  return step;
}

}  // namespace adit

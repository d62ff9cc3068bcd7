// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/plane_icp.hpp"

#include "adit/odometry/preprocess.hpp"

namespace adit {

Fields fields_of(PlaneIcpConfig& c) {
  Fields fields = fields_of(static_cast<ScanToMapConfig&>(c));
  fields.push_back(
      {"stationary_motion", &c.stationary_motion, "", 0.0, 1.0,
       "norm of the wheel motion [m; rad] since the last registered scan up to which none is registered"});
  fields.push_back({"sigma", &c.sigma, "m", 1e-3, 1.0, "of a point's distance from its plane"});
  append(fields, "wheels", fields_of(c.wheels));
  return fields;
}

PlaneIcp::PlaneIcp(const PlaneIcpConfig& config, const Pose& T_base_lidar)
    : config_(config), T_base_lidar_(T_base_lidar), map_(config.voxel_size, config.max_points_per_voxel) {}

OdometryStep PlaneIcp::register_scan(const Scan& scan, const WheelDelta& wheel) {
  const Pose T_last_now = started_ ? wheel.T_base0_base1 : Pose();
  const Pose T_prediction = T_odom_base_ * T_last_now;
  std::optional<ConstantVelocity> motion;
  if (config_.deskew && started_) motion = {T_last_now, wheel.duration};
  preprocess(scan.cloud, {config_.min_range, config_.max_range}, T_base_lidar_, motion, cloud_);
  started_ = true;

  OdometryStep step = is_resting(last_registered_, T_prediction, config_.stationary_motion)
                          ? resting(*last_registered_, T_prediction)
                          : moving(T_prediction, T_last_now);
  step.stamp = scan.stamp;
  T_odom_base_ = step.T_odom_base;
  return step;
}

OdometryStep PlaneIcp::moving(const Pose& T_prediction, const Pose& T_last_now) {
  const ThinnedScan thin = thinned(cloud_.points, config_.voxel_size, thinner_);
  OdometryStep step = first_step(thin, T_prediction, config_);
  if (!map_.empty() && step.status != StepStatus::too_few_points) {
    const PlaneAlignment alignment =
        align_planes(thin.source, map_, T_prediction, wheel_information(config_.wheels, T_last_now),
                     config_.sigma, usual_share_, config_);
    usual_share_ = alignment.share_near;
    step.T_odom_base = alignment.T_map_base;
    step.status = alignment.status == StepStatus::ok && alignment.seen.degenerate ? StepStatus::degenerate
                                                                                  : alignment.status;
    step.information = alignment.seen.information;
    step.num_correspondences = alignment.num_correspondences;
    step.iterations = alignment.iterations;
  }
  update_map(map_, thin, step, config_);
  last_registered_ = enters_map(step.status) ? std::optional(step) : std::nullopt;
  return step;
}

}  // namespace adit

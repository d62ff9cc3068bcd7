// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/kinematic_icp.hpp"

#include <cmath>

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

Fields fields_of(KinematicIcpConfig& c) {
  Fields fields = fields_of(c.scan_to_map);
  fields.push_back(stationary_motion_field(&c.stationary_motion));
  return fields;
}

KinematicIcp::KinematicIcp(const KinematicIcpConfig& config, const Pose& T_base_lidar)
    : config_(config),
      T_base_lidar_(T_base_lidar),
      map_(config.scan_to_map.voxel_size, config.scan_to_map.max_points_per_voxel) {}

OdometryStep KinematicIcp::register_scan(const Scan& scan, const SensedMotion& motion) {
  const std::optional<WheelDelta> wheel = motion_.has_begun() ? motion.wheel : std::nullopt;
  const Pose T_last_now = wheel ? wheel->T_base0_base1 : motion_.until(scan.stamp);
  const Pose T_prediction = motion_.T_odom_base() * T_last_now;
  const ScanToMapConfig& config = config_.scan_to_map;
  std::optional<SweepMotion> sweep;
  if (config.deskew && wheel)
    sweep = sweep_of({T_last_now, wheel->duration});
  else if (config.deskew && motion_.last())
    sweep = sweep_of(*motion_.last());
  preprocess(scan.cloud, {config.min_range, config.max_range}, T_base_lidar_, sweep, cloud_);

  // That the robot stood before wheels fell silent does not say that it stands.
  OdometryStep step =
      wheel && is_at_rest(T_prediction) ? resting(T_prediction) : moving(T_prediction, wheel.has_value());
  step.stamp = scan.stamp;
  motion_.arrive(scan.stamp, step.T_odom_base);
  return step;
}

bool KinematicIcp::is_at_rest(const Pose& T_prediction) const {
  return last_registered_ &&
         (last_registered_->T_odom_base.inverse() * T_prediction).log().norm() <= config_.stationary_motion;
}

OdometryStep KinematicIcp::resting(const Pose& T_prediction) const {
  OdometryStep step = *last_registered_;
  step.T_odom_base = T_prediction;
  step.correction.setZero();
  if (step.status == StepStatus::no_map) step.status = StepStatus::ok;
  step.num_correspondences = 0;
  step.iterations = 0;
  return step;
}

OdometryStep KinematicIcp::moving(const Pose& T_prediction, bool by_wheels) {
  const ScanToMapConfig& config = config_.scan_to_map;
  const ThinnedScan thin = thinned_twice(cloud_.points, config.voxel_size, thinner_);
  const OdometryStep step =
      map_.empty() ? first_step(thin, T_prediction, config) : registered(thin, T_prediction, by_wheels);
  update_map(map_, thin, step, config);
  last_registered_ = enters_map(step.status) ? std::optional(step) : std::nullopt;
  return step;
}

OdometryStep KinematicIcp::registered(const ThinnedScan& scan, const Pose& T_prediction, bool by_wheels) {
  // Section III-C: uncertainty from the spacing of the map's points and from the wheels.
  const ScanToMapConfig& config = config_.scan_to_map;
  const double sigma_map = config.voxel_size / std::sqrt(config.max_points_per_voxel);
  const double max_distance = 3.0 * (sigma_map + deviations_.sigma());
  const Alignment alignment =
      align_unicycle(scan.source, map_, T_prediction, max_distance, config, by_wheels);
  if (by_wheels && alignment.status == StepStatus::ok)
    deviations_.add(point_deviation(T_prediction.inverse() * alignment.T_map_base, config.max_range));
  OdometryStep step = step_of(alignment, scan.source, map_, max_distance, config);
  step.correction = (T_prediction.inverse() * step.T_odom_base).log();
  return step;
}

}  // namespace adit

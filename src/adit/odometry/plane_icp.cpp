// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/plane_icp.hpp"

#include <cmath>

#include "adit/core/decompositions.hpp"
#include "adit/odometry/fixed_directions.hpp"
#include "adit/odometry/preprocess.hpp"

namespace adit {
namespace {

constexpr int kYoung = 5;  // scans: by then the rings of several lie in each patch of the map
constexpr int kLost = 10;  // scans in a row that match nothing: a second of a usual LiDAR
// Residuals that are as good as independent: points of one patch share the errors of its plane.
constexpr double kIndependentShare = 0.05;

// Where prior and scan balance, the pull of the prior is that of the scan: it tells where the scan alone
// would have ended. Open directions take no part.
std::optional<double> normalised_innovation(const PosePrior& prior, const PlaneAlignment& alignment) {
  const FixedDirections fixed(alignment.information);
  if (fixed.number() == 0) return {};
  const Vector6 correction = (prior.T_map_base.inverse() * alignment.T_map_base).log();
  const Vector6 pull = prior.information * correction;
  const Vector6 innovation = correction + fixed.inverse_of(alignment.information) * pull;
  const Matrix6 covariance = inverse(prior.information) + fixed.inverse_of(alignment.seen.information);
  const Matrix6 information = fixed.information(inverse(fixed.of_covariance(covariance)));
  return innovation.dot(information * innovation) / fixed.number();
}

}  // namespace

Fields fields_of(PlaneIcpConfig& c) {
  Fields fields = fields_of(c.scan_to_map);
  fields.push_back(stationary_motion_field(&c.stationary_motion));
  fields.push_back(
      {"sigma", &c.sigma, "m", 1e-3, 1.0, "standard deviation of a point's distance from its plane"});
  append(fields, "wheels", fields_of(c.wheels));
  append(fields, "motion", fields_of(c.motion));
  append(fields, "imu", fields_of(c.imu));
  append(fields, "tilt", fields_of(c.tilt));
  return fields;
}

PlaneIcp::PlaneIcp(const PlaneIcpConfig& config, const Pose& T_base_lidar)
    : config_(config),
      T_base_lidar_(T_base_lidar),
      map_(config.scan_to_map.voxel_size, config.scan_to_map.max_points_per_voxel),
      filter_(config.motion, config.wheels, config.imu) {}

OdometryStep PlaneIcp::register_scan(const Scan& scan, const SensedMotion& motion) {
  const ScanToMapConfig& config = config_.scan_to_map;
  std::optional<SweepMotion> sweep;
  if (!stamp_) level(motion);
  if (stamp_) {
    filter_.predict(*stamp_, scan.stamp, motion);
    if (motion.wheel && !wheels_.are_slipping()) filter_.measure(*motion.wheel);
    if (config.deskew) sweep = filter_.sweep();
    if (T_ref_wheels_ && motion.wheel)
      T_ref_wheels_ = *T_ref_wheels_ * motion.wheel->T_base0_base1;
    else
      T_ref_wheels_.reset();
  }
  preprocess(scan.cloud, {config.min_range, config.max_range}, T_base_lidar_, sweep, cloud_);
  stamp_ = scan.stamp;
  OdometryStep step = is_at_rest(motion) ? resting(motion.wheel->T_base0_base1) : moving(filter_.prior());
  step.stamp = scan.stamp;
  judge_wheels(motion, step);
  step.up = filter_.up();
  return step;
}

// The frame of the odometry has z upwards where the IMU feels what that is, else it is that of the first
// pose.
void PlaneIcp::level(const SensedMotion& motion) {
  if (motion.imu.empty()) return;
  reference_.T_odom_base = T_odom_last_ =
      levelled(motion.T_base_imu.rotation() * mean_of(motion.imu).specific_force);
}

bool PlaneIcp::is_at_rest(const SensedMotion& motion) const {
  if (num_in_map_ == 0 || num_missed_ > 0 || !T_ref_wheels_ ||
      T_ref_wheels_->log().norm() > config_.stationary_motion)
    return false;
  // Wheels also stand while the robot is carried.
  return motion.imu.empty() || mean_of(motion.imu).is_still;
}

void PlaneIcp::judge_wheels(const SensedMotion& motion, OdometryStep& step) {
  const double driven_m = (T_odom_last_.inverse() * step.T_odom_base).translation().x();
  T_odom_last_ = step.T_odom_base;
  step.slip.reset();
  if (!motion.wheel) return;
  const double counted_m = motion.wheel->T_base0_base1.translation().x();
  wheels_.compare(counted_m, driven_m, std::sqrt(covariance_(0, 0)));
  if (wheels_.are_slipping()) step.slip = counted_m - driven_m;
}

OdometryStep PlaneIcp::resting(const Pose& T_last_now) {
  filter_.stopped(T_last_now);
  OdometryStep step = reference_;
  step.T_odom_base = step.T_odom_base * *T_ref_wheels_;
  if (step.status == StepStatus::no_map) step.status = StepStatus::ok;
  step.predicted.reset();
  step.correction.setZero();
  step.num_correspondences = 0;
  step.iterations = 0;
  return step;
}

OdometryStep PlaneIcp::moving(const MotionPrior& prior) {
  const ScanToMapConfig& config = config_.scan_to_map;
  const ThinnedScan thin = thinned_twice(cloud_.points, config.voxel_size, thinner_);
  if (num_unmatched_ + 1 >= kLost) map_ = LocalMap(config.voxel_size, config.max_points_per_voxel);
  if (map_.empty()) num_in_map_ = 0;
  const Pose T_prediction = reference_.T_odom_base * prior.T_ref_now;
  covariance_ = prior.covariance;
  onto_fixed_.setZero();
  OdometryStep step = map_.empty()
                          ? first_step(thin, T_prediction, config)
                          : registered(thin, {T_prediction, inverse(prior.covariance), usual_share_});
  step.correction = (T_prediction.inverse() * step.T_odom_base).log();
  update_map(map_, thin, step, config);
  remember(step, thin);
  step.predicted = {prior.covariance, filter_.open_drift(), filter_.is_by_imu()};
  return step;
}

OdometryStep PlaneIcp::registered(const ThinnedScan& scan, const PosePrior& prior) {
  OdometryStep step = first_step(scan, prior.T_map_base, config_.scan_to_map);
  if (step.status == StepStatus::too_few_points) return step;
  ScanToMapConfig config = config_.scan_to_map;
  // What one scan may find since the last one.
  config.max_correction *= 1.0 + num_missed_;
  config.max_turn_deg *= 1.0 + num_missed_;
  const PlaneAlignment alignment = align_point_to_plane(scan.source, map_, prior, config_.sigma, config);
  const bool is_young = num_in_map_ < kYoung;
  if (alignment.status == StepStatus::too_few_points && is_young) return step;  // as the first scan
  if (alignment.status == StepStatus::ok) {
    usual_share_ = alignment.share_near;
    covariance_ = inverse(Matrix6(prior.information + kIndependentShare * alignment.information));
    onto_fixed_ = alignment.seen.onto_fixed;
    step.innovation = normalised_innovation(prior, alignment);
  }
  step.T_odom_base = alignment.T_map_base;
  step.status = alignment.status == StepStatus::ok && alignment.seen.degenerate ? StepStatus::degenerate
                                                                                : alignment.status;
  step.information = alignment.seen.information;
  step.num_correspondences = alignment.num_correspondences;
  step.iterations = alignment.iterations;
  return step;
}

void PlaneIcp::remember(const OdometryStep& step, const ThinnedScan& scan) {
  if (enters_map(step.status)) {
    filter_.registered(reference_.T_odom_base.inverse() * step.T_odom_base, covariance_, onto_fixed_,
                       kIndependentShare);
    reference_ = step;
    T_ref_wheels_ = Pose();
    num_missed_ = num_unmatched_ = 0;
    ++num_in_map_;
    return;
  }
  filter_.missed();
  ++num_missed_;
  const auto enough = static_cast<std::size_t>(config_.scan_to_map.min_correspondences);
  num_unmatched_ = scan.source.size() >= enough ? num_unmatched_ + 1 : 0;
}

}  // namespace adit

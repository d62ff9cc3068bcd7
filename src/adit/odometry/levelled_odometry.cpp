// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/levelled_odometry.hpp"

#include <utility>

#include "adit/odometry/imu_integral.hpp"

namespace adit {
namespace {

// Scans whose first and last give the velocity at the middle one.
constexpr std::size_t kMoments = 5;
// Metres over which a force is averaged.
constexpr double kLeastM = 1.0;
// Share of gravity that is felt at least, of an IMU that works.
constexpr double kLeastForce = 0.5;

}  // namespace

LevelledOdometry::LevelledOdometry(std::unique_ptr<Odometry> odometry, const TiltNoise& noise)
    : odometry_(std::move(odometry)), tilt_(noise) {}

OdometryStep LevelledOdometry::register_scan(const Scan& scan, const SensedMotion& motion) {
  OdometryStep step = odometry_->register_scan(scan, motion);
  if (last_) feel(step, motion);
  last_ = {step.stamp, step.T_odom_base};
  if (T_level_odom_) step.T_odom_base = *T_level_odom_ * step.T_odom_base;
  return step;
}

void LevelledOdometry::feel(const OdometryStep& step, const SensedMotion& motion) {
  const Vector3& at = step.T_odom_base.translation();
  driven_m_ += (at - last_->T_world_body.translation()).norm();
  if (motion.imu.empty()) {
    moments_.clear();
    begin_.reset();
    return;
  }
  const double dt = to_seconds(step.stamp - last_->stamp);
  const Matrix3 R_odom_base = step.T_odom_base.rotation_matrix();
  Moment now = moments_.empty() ? Moment() : moments_.back();
  now.stamp = step.stamp;
  now.imu = step.T_odom_base * motion.T_base_imu.translation();
  now.force += dt * (R_odom_base * (motion.T_base_imu.rotation() * mean_of(motion.imu).specific_force));
  now.rotation += dt * R_odom_base;
  now.driven_m = driven_m_;
  moments_.push_back(now);
  if (moments_.size() < kMoments) return;
  if (moments_.size() > kMoments) moments_.pop_front();
  Moment end = moments_[kMoments / 2];
  end.velocity = (moments_.back().imu - moments_.front().imu) /
                 to_seconds(moments_.back().stamp - moments_.front().stamp);
  if (!begin_) begin_ = end;
  const double measured_m = end.driven_m - begin_->driven_m;
  if (measured_m < kLeastM) return;
  const double seconds = to_seconds(end.stamp - begin_->stamp);
  const Vector3 gravity = (end.force - begin_->force - (end.velocity - begin_->velocity)) / seconds;
  if (gravity.norm() > kLeastForce * kGravity) {
    tilt_.measure(gravity, (end.rotation - begin_->rotation) / seconds, measured_m,
                  end.driven_m - driven_before_m_);
    driven_before_m_ = end.driven_m;
  }
  begin_ = end;
  // The path goes on from where it is.
  const Eigen::Quaterniond R = tilt_.R_start_now();
  T_level_odom_ = Pose(R, T_level_odom_.value_or(Pose()) * at - R * at);
}

}  // namespace adit

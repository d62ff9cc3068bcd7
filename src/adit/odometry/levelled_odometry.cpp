// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/levelled_odometry.hpp"

#include <utility>

#include "adit/core/check.hpp"
#include "adit/odometry/imu_integral.hpp"

namespace adit {
namespace {

// Scans whose first and last give the velocity at the middle one.
constexpr std::size_t kMoments = 5;
// A force is averaged over so many metres and seconds: over less, the errors of two velocities would be more
// than what shaking leaves.
constexpr double kLeastM = 1.0;
constexpr double kLeastS = 0.5;
// Share of gravity that is felt at least, of an IMU that works.
constexpr double kLeastForce = 0.5;

}  // namespace

LevelledOdometry::LevelledOdometry(std::unique_ptr<Odometry> odometry, const TiltNoise& noise)
    : odometry_(std::move(odometry)), tilt_(noise) {
  ADIT_CHECK(odometry_ != nullptr, "there is an odometry to level");
}

OdometryStep LevelledOdometry::register_scan(const Scan& scan, const SensedMotion& motion) {
  OdometryStep step = odometry_->register_scan(scan, motion);
  const Pose T_drifted_base = step.T_odom_base;
  const bool is_ready = last_ && add_moment(step, motion);
  last_ = {step.stamp, T_drifted_base};
  if (is_ready) measure_up();
  if (T_odom_drifted_) step.T_odom_base = *T_odom_drifted_ * T_drifted_base;
  return step;
}

bool LevelledOdometry::add_moment(const OdometryStep& step, const SensedMotion& motion) {
  const Pose& T_drifted_base = step.T_odom_base;
  driven_m_ += (T_drifted_base.translation() - last_->T_world_body.translation()).norm();
  const bool is_aligned = step.status == StepStatus::ok || step.status == StepStatus::degenerate;
  has_map_ = has_map_ || is_aligned;
  // Scans that begin a map are no jump at the start alone: later the robot has left its map behind.
  const bool is_registered = is_aligned || (step.status == StepStatus::no_map && !has_map_);
  if (!is_registered) tilt_.expect_jump();
  if (motion.imu.empty() || !is_registered) {
    moments_.clear();
    begin_.reset();
    return false;
  }
  const double dt = to_seconds(step.stamp - last_->stamp);
  const Matrix3 R_drifted_base = T_drifted_base.rotation_matrix();
  Moment now = moments_.empty() ? Moment() : moments_.back();
  now.stamp = step.stamp;
  now.imu = T_drifted_base * motion.T_base_imu.translation();
  now.force += dt * (R_drifted_base * (motion.T_base_imu.rotation() * mean_of(motion.imu).specific_force));
  now.rotation += dt * R_drifted_base;
  now.driven_m = driven_m_;
  moments_.push_back(now);
  if (moments_.size() > kMoments) moments_.pop_front();
  return moments_.size() == kMoments;
}

void LevelledOdometry::measure_up() {
  End end{moments_[kMoments / 2]};
  end.velocity = (moments_.back().imu - moments_.front().imu) /
                 to_seconds(moments_.back().stamp - moments_.front().stamp);
  if (!begin_) begin_ = end;
  const Moment& from = begin_->at;
  const Moment& to = end.at;
  const double measured_m = to.driven_m - from.driven_m;
  const double seconds = to_seconds(to.stamp - from.stamp);
  if (measured_m < kLeastM || seconds < kLeastS) return;
  const Vector3 against_gravity = (to.force - from.force - (end.velocity - begin_->velocity)) / seconds;
  if (against_gravity.norm() > kLeastForce * kGravity) {
    tilt_.measure(against_gravity, (to.rotation - from.rotation) / seconds, measured_m,
                  to.driven_m - driven_before_m_);
    driven_before_m_ = to.driven_m;
  }
  begin_ = end;
  // The path goes on from where it is.
  const Eigen::Quaterniond R = tilt_.R_start_now();
  const Vector3& at = last_->T_world_body.translation();
  T_odom_drifted_ = Pose(R, T_odom_drifted_.value_or(Pose()) * at - R * at);
}

}  // namespace adit

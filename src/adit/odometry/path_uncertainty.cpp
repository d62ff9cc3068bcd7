// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/path_uncertainty.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "adit/core/angles.hpp"
#include "adit/odometry/fixed_directions.hpp"
#include "adit/odometry/scan_to_map.hpp"

namespace adit {
namespace {

constexpr int kRemembered = 50;  // scans: five seconds of a usual LiDAR
// Scans that hit the same surfaces of the map and err alike.
constexpr std::size_t kAlike = 3;
// Metres of path that turning by a radian is worth: it brings new walls into view, too.
constexpr double kMetresPerRadian = 1.0;
constexpr double kLeast = 1e-4;  // metres

}  // namespace

Fields fields_of(PathNoise& c) {
  return {
      {"drift_per_metre", &c.drift_per_metre, "1/m", 1e-3, 1e3,
       "variance that a metre adds to the path, in covariances of one registration"},
      {"roll_pitch_deg", &c.roll_pitch_deg, "deg/sqrt(m)", 0.0, 10.0,
       "random walk of roll and pitch that no scan states, as ranges of one LiDAR err alike in all scans"},
      {"translation", &c.translation, "m/sqrt(m)", 1e-4, 1.0,
       "of odometries that do not state how well they predict"},
      {"rotation_deg", &c.rotation_deg, "deg/sqrt(m)", 1e-4, 10.0, "likewise"},
      {"guessed", &c.guessed, "", 1.0, 100.0,
       "factor on that noise where scans come at irregular intervals and there are no wheels"}};
}

Matrix6 random_walk(const PathNoise& noise, double distance_m) {
  const double distance = std::max(distance_m, 0.01);
  const double rotation = noise.rotation_deg * kDegree;
  Vector6 variance;
  variance << Vector3::Constant(noise.translation * noise.translation * distance),
      Vector3::Constant(rotation * rotation * distance);
  return variance.asDiagonal();
}

void PathUncertainty::add(const OdometryStep& step) {
  if (!enters_map(step.status)) return;
  if (!T_odom_last_) {
    T_odom_last_ = T_odom_begin_ = step.T_odom_base;
    return;
  }
  const Pose T_last_now = T_odom_last_->inverse() * step.T_odom_base;
  T_odom_last_ = step.T_odom_base;
  const double metres = T_last_now.translation().norm() + kMetresPerRadian * T_last_now.angle();
  const Matrix6 onto_now = T_last_now.inverse().adjoint();
  drift_ = carry_covariance(onto_now, drift_) + drift_of(step, metres);
  for (Vector6& correction : recent_) correction = onto_now * correction;
  // A step that was registered from a choice of starts was not predicted, and a robot at rest is not
  // registered.
  if (!step.is_guess && step.num_correspondences > 0) learn(step);
}

Matrix6 PathUncertainty::drift_of(const OdometryStep& step, double metres) {
  registration_ = FixedDirections(step.information).inverse_of(step.information);
  if (!step.predicted && step.num_correspondences > 0) is_stated_ = false;
  is_guessed_ = is_guessed_ || step.is_guess;
  if (!step.predicted) return Matrix6::Zero();
  Matrix6 drift = config_.drift_per_metre * metres * registration_ + step.predicted->open_drift;
  drift.block<2, 2>(3, 3).diagonal().array() += std::pow(config_.roll_pitch_deg * kDegree, 2) * metres;
  return drift;
}

Matrix6 PathUncertainty::drift() const {
  if (is_stated_ || !T_odom_last_) return with_sigma_at_least(drift_, kLeast);
  const double factor = is_guessed_ ? config_.guessed : 1.0;
  return factor * factor *
         random_walk(config_, (T_odom_begin_.inverse() * *T_odom_last_).translation().norm());
}

void PathUncertainty::begin_edge() {
  T_odom_begin_ = T_odom_last_.value_or(Pose());
  is_stated_ = true;
  is_guessed_ = false;
  drift_.setZero();
}

void PathUncertainty::learn(const OdometryStep& step) {
  // Where an IMU follows the motion, what is corrected is noise of the registrations, little by little.
  const std::size_t alike = step.predicted && step.predicted->by_imu ? kAlike : 1;
  recent_.push_back(step.correction);
  while (recent_.size() > alike) recent_.pop_front();
  const Vector6 sum = std::accumulate(recent_.begin(), recent_.end(), Vector6(Vector6::Zero()));
  num_corrections_ = std::min(num_corrections_ + 1, kRemembered);
  corrections_ += (sum * sum.transpose() - corrections_) / num_corrections_;
}

}  // namespace adit

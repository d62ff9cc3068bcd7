// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/tilt_filter.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "adit/core/angles.hpp"
#include "adit/core/check.hpp"
#include "adit/odometry/imu_integral.hpp"

namespace adit {
namespace {

constexpr double kUnknown = 0.5;   // of up at the start: half of its length
constexpr double kMostSigmas = 5;  // of a force that is believed

Vector3 unit_with(const Eigen::Vector2d& horizontal) {
  return {horizontal.x(), horizontal.y(), std::sqrt(std::max(0.0, 1.0 - horizontal.squaredNorm()))};
}

}  // namespace

Fields fields_of(TiltNoise& c) {
  return {{"drift_deg", &c.drift_deg, "deg/sqrt(m)", 0.0, 10.0,
           "drift of roll and pitch that an IMU takes out, after one metre; 0: none is taken out"},
          {"force_deg", &c.force_deg, "deg sqrt(m)", 1e-3, 90.0,
           "direction of the mean specific force over one metre"},
          {"offset_deg", &c.offset_deg, "deg", 0.0, 90.0,
           "bias of the accelerometer, and its mount against that of the LiDAR"}};
}

TiltFilter::TiltFilter(const TiltNoise& noise) : noise_(noise) {
  for (Eigen::Index i = 0; i < 2; ++i)
    for (const Eigen::Index row : {kStart + i, kNow + i})
      for (const Eigen::Index column : {kStart + i, kNow + i}) covariance_(row, column) = kUnknown * kUnknown;
  covariance_.block<3, 3>(kOffset, kOffset).diagonal().setConstant(std::pow(noise.offset_deg * kDegree, 2));
}

void TiltFilter::measure(const Vector3& force, const Matrix3& R_odom_base, double measured_m,
                         double driven_m) {
  ADIT_CHECK(measured_m > 0.0, "a force is felt over some distance");
  const Vector3 up = force.normalized();
  if (num_believed_ == 0) R_up_odom_ = levelled(up).rotation_matrix();
  covariance_.block<2, 2>(kNow, kNow).diagonal().array() +=
      std::pow(noise_.drift_deg * kDegree, 2) * driven_m;
  Eigen::Matrix<double, 2, kSize> H = Eigen::Matrix<double, 2, kSize>::Zero();
  H.middleCols<2>(kNow).setIdentity();
  H.middleCols<3>(kOffset) = (R_up_odom_ * R_odom_base).topRows<2>();
  const Eigen::Vector2d innovation = (R_up_odom_ * up).head<2>() - H * state_;
  Eigen::Matrix2d S = H * covariance_ * H.transpose();
  S.diagonal().array() += std::pow(noise_.force_deg * kDegree, 2) / measured_m;
  const Eigen::LLT<Eigen::Matrix2d> factor(S);
  if (innovation.dot(factor.solve(innovation)) > kMostSigmas * kMostSigmas) {
    if (num_believed_ == 1)
      *this = TiltFilter(noise_);
    else if (may_have_jumped_)
      forget_now();
    return;
  }
  ++num_believed_;
  may_have_jumped_ = false;
  const Eigen::Matrix<double, kSize, 2> gain = factor.solve(H * covariance_).transpose();
  state_ += gain * innovation;
  covariance_ -= gain * H * covariance_;
  covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
}

/// What was up before a jump says nothing of what is up now; the start and the offset are what they were.
void TiltFilter::forget_now() {
  covariance_.middleRows<2>(kNow).setZero();
  covariance_.middleCols<2>(kNow).setZero();
  covariance_.block<2, 2>(kNow, kNow).diagonal().setConstant(kUnknown * kUnknown);
}

Eigen::Quaterniond TiltFilter::R_start_now() const {
  const Vector3 start = unit_with(state_.segment<2>(kStart));
  const Vector3 now = unit_with(state_.segment<2>(kNow));
  // The shortest turn: half of it is between the two.
  const Vector3 axis = R_up_odom_.transpose() * now.cross(start);
  return Eigen::Quaterniond(1.0 + now.dot(start), axis.x(), axis.y(), axis.z()).normalized();
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include "adit/core/config.hpp"
#include "adit/core/pose.hpp"

namespace adit {

/// How the attitude of an odometry drifts, and how well an IMU feels what is up. Standard deviations,
/// set by simulated drives with shaking IMUs (docs/decisions/0090-gravity-keeps-a-map-level.md).
struct TiltNoise {
  double drift_deg = 0.03;  ///< Roll and pitch of the odometry, a random walk: degrees after one metre.
  double force_deg = 1.0;   ///< Direction of the mean specific force over one metre, which shaking blurs.
  double offset_deg = 2.0;  ///< The accelerometer's bias, and its mount against the LiDAR's: one for a drive.
};
/// The keys are the names of the fields.
[[nodiscard]] Fields fields_of(TiltNoise& noise);

/// Kalman filter of the direction that is up in the frame of an odometry, at the start and now, and of the
/// accelerometer's offset, which is constant in the body. The difference between up at the start and now is
/// what roll and pitch have drifted by. While the robot keeps its heading an offset looks like a tilt that
/// stays, which does no harm; once it turns the two part.
class TiltFilter {
 public:
  /// Of a drive that begins; what is up is hardly known.
  explicit TiltFilter(const TiltNoise& noise);

  /// `force`: mean of the specific force less the mean acceleration, any length but zero, in the odometry's
  /// frame; `R_odom_base`: mean of the body's rotation meanwhile. `measured_m`: metres driven meanwhile,
  /// positive; `driven_m`: since the call before, those without an IMU included. A force that is more than
  /// five standard deviations off (a step of the odometry that is wrong) is left out; where only one came
  /// before, so is that one, as nobody knows which of them is off.
  void measure(const Vector3& force, const Matrix3& R_odom_base, double measured_m, double driven_m);
  /// The odometry went on without a scan, so that its attitude may have jumped: if the next force is off, up
  /// is learnt anew.
  void expect_jump() { may_have_jumped_ = true; }
  /// Takes what is up now, in the odometry's frame, to what was at the start. The identity at first.
  [[nodiscard]] Eigen::Quaterniond R_start_now() const;

 private:
  // Horizontal parts of the unit vector up at the start and now, in a frame in which it is nearly z; the
  // offset over gravity, body frame.
  static constexpr Eigen::Index kStart = 0;
  static constexpr Eigen::Index kNow = 2;
  static constexpr Eigen::Index kOffset = 4;
  static constexpr int kSize = 7;
  using State = Eigen::Matrix<double, kSize, 1>;
  using Covariance = Eigen::Matrix<double, kSize, kSize>;

  void forget_now();

  TiltNoise noise_;
  int num_believed_ = 0;  ///< Forces.
  bool may_have_jumped_ = false;
  Matrix3 R_up_odom_ = Matrix3::Identity();
  State state_ = State::Zero();
  Covariance covariance_ = Covariance::Zero();
};

}  // namespace adit

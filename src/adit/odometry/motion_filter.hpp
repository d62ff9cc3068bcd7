// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/geometry/deskew.hpp"
#include "adit/odometry/imu_integral.hpp"

namespace adit {

/// How fast a robot may change its motion where no sensor measures it: its twist is a random walk. Standard
/// deviations after one second; after a tenth of that, a third of them. The defaults allow for a robot that
/// starts and brakes hard.
struct MotionNoise {
  double speed = 2.0;      ///< Metres per second.
  double turn_rate = 2.0;  ///< Radians per second.
};
/// The keys are the names of the fields.
[[nodiscard]] Fields fields_of(MotionNoise& noise);

/// Standard deviations of the wheels' motion between two scans, per metre driven. Wheels that measure in a
/// plane know nothing of climbing and tilting; there the figures are those of a rough floor.
struct WheelNoise {
  double slip = 0.02;            ///< Forward, metres per metre, each interval by itself.
  double sideways = 0.01;        ///< Metres per metre.
  double climb = 0.25;           ///< Metres per metre.
  double tilt_deg = 10.0;        ///< Roll and pitch, degrees per metre.
  double heading_deg = 0.5;      ///< Degrees per metre.
  double turn = 0.05;            ///< Heading again, share of the angle turned.
  double scale = 0.02;           ///< Of their radius, the same over the whole drive: share of the distance.
  double yaw_deg = 1.0;          ///< Of the direction in which they drive against the base: a LiDAR is
                                 ///< mounted to within a degree or two. The same over the whole drive.
  double slip_that_lasts = 0.1;  ///< Forward again, fading within `slip_time`: metres per metre.
  double slip_time = 1.0;        ///< Seconds.
};
/// The keys are the names of the fields.
[[nodiscard]] Fields fields_of(WheelNoise& noise);

/// Covariance of the error of the wheels' motion T_base0_base1 in an interval, without those of their scale
/// and of slip that lasts; right perturbation, [translation; rotation].
[[nodiscard]] Matrix6 wheel_covariance(const WheelNoise& noise, const Pose& T_base0_base1);

/// What is known of a motion before the LiDAR has measured it.
struct MotionPrior {
  Pose T_ref_now;                        ///< From the last scan whose pose was measured.
  Matrix6 covariance = Matrix6::Zero();  ///< Right perturbation, [translation; rotation].
};

/// Error-state Kalman filter of a robot's motion since the last scan whose pose was measured, its reference.
/// It holds the pose at the last scan, the motion since then, the twist, the wheels' scale, the direction in
/// which they drive and their slip (a first-order Gauss-Markov process), gravity and the biases of the IMU,
/// with their joint covariance; poses are relative to the reference, so that what is asked of it is what a
/// scan must add (robocentric, as in C. Qin et al., "LINS: A Lidar-Inertial State Estimator for Robust and
/// Efficient Navigation", ICRA 2020). Each interval between two scans is predicted by the IMU where it
/// measured, else with a constant twist; then the wheels correct it where they measured. Over scans that
/// could not be measured the uncertainty grows.
class MotionFilter {
 public:
  /// At the first scan, with a twist of which little is known.
  MotionFilter(const MotionNoise& motion, const WheelNoise& wheels, const ImuNoise& imu);

  /// The next interval begins and ends; `begin` before `end`. Before the first one, nothing can be learned:
  /// what is said of the first scan is ignored. Of `motion`, what was measured in between, the IMU.
  void predict(Stamp begin, Stamp end, const SensedMotion& motion);
  /// What the wheels say about the interval predicted last. The farther off ahead, the less they weigh: they
  /// may slip. Their scale and slip are not corrected by it, only considered: scans tell those (S. F.
  /// Schmidt, 1966). Source: Huber, "Robust Estimation of a Location Parameter" (1964).
  void measure(const WheelDelta& wheel);

  /// The motion in the interval predicted last.
  [[nodiscard]] const Pose& T_last_now() const { return T_last_now_; }
  /// Whether the IMU measured it.
  [[nodiscard]] bool is_by_imu() const { return !path_.poses().empty(); }
  /// The body's way through that interval.
  [[nodiscard]] SweepMotion sweep() const;
  /// Against gravity, unit length, body frame at the last scan; none before an IMU has measured.
  [[nodiscard]] std::optional<Vector3> up() const;
  /// The motion since the reference.
  [[nodiscard]] MotionPrior prior() const;

  /// The pose of this scan in the frame of the reference was found, by the prior and the scan together; the
  /// scan becomes the reference. `covariance` as in MotionPrior. Where the scan measured, the error that is
  /// left is one against the map and stays; where the prior alone decided, the scan takes the map along, so
  /// that nothing is left of it. `onto_fixed`: the projection onto the directions that the scan fixes.
  /// `share_counted`: where the pose was found as if all residuals of the scan were independent, the share of
  /// their information that `covariance` counts; what else is held learns from that share alone.
  void registered(const Pose& T_ref_now, const Matrix6& covariance,
                  const Matrix6& onto_fixed = Matrix6::Identity(), double share_counted = 1.0);
  /// See PredictedMotion::open_drift; of the scan registered last.
  [[nodiscard]] const Matrix6& open_drift() const { return open_drift_; }
  /// The scan was not measured: its interval joins those before.
  void missed();
  /// The robot stands still, as its wheels say: they are believed, and the interval joins those before.
  void stopped(const Pose& T_last_now);

  /// Metres driven per metre that the wheels count, less one.
  [[nodiscard]] double wheel_scale() const { return scale_; }
  /// Standard deviation of that.
  [[nodiscard]] double wheel_scale_sigma() const { return std::sqrt(covariance_(kScale, kScale)); }

 private:
  // Where the errors of each part lie: pose of the last scan, motion since, twist, scale, gravity, biases of
  // gyroscope and accelerometer, slip and direction of the wheels, and of the path up to the reference along
  // directions that scans left open. That one is past and no longer corrected: it is held for what it has in
  // common with the others (a "consider" state, S. F. Schmidt, 1966).
  static constexpr Eigen::Index kLast = 0;
  static constexpr Eigen::Index kMotion = 6;
  static constexpr Eigen::Index kTwist = 12;
  static constexpr Eigen::Index kScale = 18;
  static constexpr Eigen::Index kGravityAt = 19;
  static constexpr Eigen::Index kGyro = 22;
  static constexpr Eigen::Index kAccel = 25;
  static constexpr Eigen::Index kSlip = 28;
  static constexpr Eigen::Index kYaw = 29;
  static constexpr Eigen::Index kPath = 30;
  static constexpr int kSize = 36;
  using State = Eigen::Matrix<double, kSize, 1>;
  using Covariance = Eigen::Matrix<double, kSize, kSize>;
  using Rows6 = Eigen::Matrix<double, 6, kSize>;
  using Columns6 = Eigen::Matrix<double, kSize, 6>;
  static constexpr double kUnknownTwist =
      3.0;  ///< Metres and radians per second: no robot is faster at first.

  void predict_slip(double dt);
  void predict_by_twist(double dt, double horizon);  ///< Seconds; for how long the twist is kept.
  void predict_by_imu(const SensedMotion& motion);
  /// The first time that the IMU measures.
  void start_imu(const SensedMotion& motion);
  [[nodiscard]] Rows6 jacobian_of_prior() const;
  void extend_path(const Pose& T_ref_now, const Matrix6& onto_fixed);
  /// Corrects the state by `error` and takes `known` out of the covariance, but not from the path's own.
  void correct(const State& error, const Covariance& known);
  /// From here on, poses are relative to the end of the interval.
  void begin_interval();

  MotionNoise motion_;
  WheelNoise wheels_;
  ImuNoise imu_;
  bool started_ = false;
  bool has_imu_ = false;  ///< It has measured at least once.
  Stamp begin_;           ///< Of the interval predicted last.
  Stamp end_;
  BodyPath path_;  ///< By the IMU alone, through that interval; empty where it did not measure.
  Pose T_ref_last_;
  Pose T_last_now_;
  Vector6 twist_ = Vector6::Zero();  ///< Of the body, per second.
  double scale_ = 0.0;
  double slip_ = 0.0;  ///< As scale_, for now.
  double yaw_ = 0.0;   ///< Of the wheels, radians.
  ImuStart felt_;      ///< Gravity in the body frame, and the biases; its velocity is that of `twist_`.
  Covariance covariance_;
  Matrix6 open_drift_ = Matrix6::Zero();
};

}  // namespace adit

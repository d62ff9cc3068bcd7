// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The motion that an IMU measured between two scans.
#pragma once

#include <span>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"

namespace adit {

inline constexpr double kGravity = 9.80665;  ///< Metres per second squared (standard gravity).

/// Noise of an IMU's two sensors, as data sheets state it. The defaults are rounded up from those of IMUs
/// that LiDARs have built in. What vibration adds is measured (noise_over).
struct ImuNoise {
  double gyroscope = 5e-4;            ///< Density, rad/s/sqrt(Hz).
  double accelerometer = 5e-3;        ///< Density, m/s2/sqrt(Hz).
  double gyroscope_bias = 5e-5;       ///< Random walk: sigma after one second, rad/s.
  double accelerometer_bias = 5e-4;   ///< The same, m/s2.
  double gyroscope_start = 0.02;      ///< Bias when switched on, rad/s.
  double accelerometer_start = 0.15;  ///< The same, m/s2.
};
/// The keys are the names of the fields.
[[nodiscard]] Fields fields_of(ImuNoise& noise);

/// `stated`, with the densities that the samples themselves show where those are larger: on a vehicle that
/// shakes, the noise is not that of the data sheet. What changes slowly from sample to sample is motion; it
/// is taken out by second differences, whose variance is six times that of white noise (the successive
/// differences of J. von Neumann et al., "The Mean Square Successive Difference", 1941, once more). Of fewer
/// than four samples, of ones that are not finite or do not take time, nothing is measured.
[[nodiscard]] ImuNoise noise_over(std::span<const ImuSample> samples, const ImuNoise& stated);

/// What the integral starts from; body frame at the begin unless it says otherwise.
struct ImuStart {
  Vector3 velocity = Vector3::Zero();            ///< Of the body's origin.
  Vector3 turn_rate = Vector3::Zero();           ///< By it the IMU's own velocity follows.
  Vector3 gravity = Vector3::Zero();             ///< Downwards, metres per second squared.
  Vector3 gyroscope_bias = Vector3::Zero();      ///< IMU frame.
  Vector3 accelerometer_bias = Vector3::Zero();  ///< IMU frame.
};

/// Poses of a body over time, in its frame at the first of them.
class BodyPath {
 public:
  /// Stamps ascend; the first pose is the identity.
  void add(Stamp stamp, const Pose& T_begin_body) { poses_.push_back({stamp, T_begin_body}); }
  /// In the frame of the first pose; outside the span as if the body moved on with its first or last twist.
  /// Needs two poses.
  [[nodiscard]] Pose at(Stamp stamp) const;
  /// T_begin_body, as they were added.
  [[nodiscard]] const Trajectory& poses() const { return poses_; }

 private:
  Trajectory poses_;
};

/// The motion of the body over an interval, with derivatives by the start and noise. Errors of the answer, in
/// this order: T_begin_end (right perturbation, [translation; rotation]), velocity and turn rate at the end
/// (end frame); of the start: velocity, turn rate, gravity, gyroscope's and accelerometer's bias. The
/// integration is that of C. Forster, L. Carlone, F. Dellaert, D. Scaramuzza, "On-Manifold Preintegration for
/// Real-Time Visual-Inertial Odometry", T-RO 2017, section V, with the middle of two samples between them and
/// with the IMU away from the body's origin.
struct ImuIntegral {
  BodyPath path;                    ///< A pose at each sample, the first at the begin, the last at the end.
  Pose T_begin_end;                 ///< Of the body, over the whole interval.
  Vector6 twist = Vector6::Zero();  ///< At the end, in its frame: velocity, turn rate.
  /// Errors of the answer by those of the start.
  Eigen::Matrix<double, 12, 15> jacobian = Eigen::Matrix<double, 12, 15>::Zero();
  /// Covariance of the answer by the noise of the samples alone.
  Eigen::Matrix<double, 12, 12> noise = Eigen::Matrix<double, 12, 12>::Zero();
};
/// `motion.imu` as SensedMotion documents it, not empty; `begin` before `end`.
[[nodiscard]] ImuIntegral integrated(const SensedMotion& motion, Stamp begin, Stamp end,
                                     const ImuStart& start, const ImuNoise& noise);

/// Means over samples, in the IMU's frame.
struct ImuMean {
  Vector3 angular_velocity = Vector3::Zero();  ///< Radians per second, with the bias.
  Vector3 specific_force = Vector3::Zero();    ///< m/s2, with the bias: at rest it is against gravity.
  bool is_still = false;  ///< Neither turned nor shook: a robot that stands, or a very smooth ride.
};
/// `samples` not empty.
[[nodiscard]] ImuMean mean_of(std::span<const ImuSample> samples);

/// The attitude of the body by what it feels of gravity, with heading zero: takes `up` (body frame, any
/// length but zero) to z.
[[nodiscard]] Pose levelled(const Vector3& up);

}  // namespace adit

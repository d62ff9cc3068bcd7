// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/motion_filter.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "adit/core/angles.hpp"
#include "adit/core/check.hpp"
#include "adit/core/decompositions.hpp"
#include "adit/odometry/fixed_directions.hpp"
#include "adit/odometry/steady_motion.hpp"

namespace adit {
namespace {

// Encoder ticks and the clock leave this much open for a robot that hardly moves.
constexpr double kFloor = 0.001;       // metres
constexpr double kTurnFloor = 0.0002;  // radians
constexpr double kSlipFloor = 2 * kFloor;
// Wheels farther off than this, in standard deviations, weigh less (Huber 1964: as good as 95 % of the
// measurements where errors are normal).
constexpr double kHuber = 1.345;

// What is not known of gravity at first where the robot may be accelerating, m/s2.
constexpr double kAcceleration = 1.0;
// Gravity's length is known: share of its error along itself.
constexpr double kGravityLength = 0.02;
constexpr double kStillTurnRate = 0.002;  // rad/s: bias of the gyroscope after a still interval
constexpr double kSweepRate = 200.0;      // knots per second of a sweep that the IMU measured

template <class Matrix>
void make_symmetric(Matrix& m) {
  m = (0.5 * (m + m.transpose())).eval();
}

}  // namespace

Fields fields_of(MotionNoise& c) {
  return {{"speed", &c.speed, "m/s", 1e-3, 100.0, "change of velocity within a second"},
          {"turn_rate", &c.turn_rate, "rad/s", 1e-3, 100.0, "change of the rate of turning within a second"}};
}

Fields fields_of(WheelNoise& c) {
  return {{"slip", &c.slip, "", 1e-4, 1.0, "forward, per metre driven, each interval by itself"},
          {"sideways", &c.sideways, "", 1e-4, 1.0, "sideways, per metre"},
          {"climb", &c.climb, "", 1e-4, 10.0, "up and down, per metre"},
          {"tilt_deg", &c.tilt_deg, "deg/m", 1e-3, 360.0, "roll and pitch, per metre"},
          {"heading_deg", &c.heading_deg, "deg/m", 1e-3, 360.0, "heading, per metre"},
          {"turn", &c.turn, "", 1e-4, 1.0, "heading again, share of the angle turned"},
          {"scale", &c.scale, "", 0.0, 1.0, "error of the wheels' radius, the same over the whole drive"},
          {"yaw_deg", &c.yaw_deg, "deg", 0.0, 10.0,
           "of the direction in which they drive against the base, the same over the whole drive"},
          {"slip_that_lasts", &c.slip_that_lasts, "", 0.0, 1.0, "forward again, fading within slip_time"},
          {"slip_time", &c.slip_time, "s", 0.01, 100.0, "how long slip lasts"}};
}

Matrix6 wheel_covariance(const WheelNoise& noise, const Pose& T_base0_base1) {
  const double distance = T_base0_base1.translation().norm();
  const double tilt = noise.tilt_deg * kDegree * distance + 2 * kTurnFloor;
  Vector6 sigma;
  sigma << noise.slip * distance + kSlipFloor, noise.sideways * distance + kFloor,
      noise.climb * distance + kFloor, tilt, tilt,
      noise.heading_deg * kDegree * distance + noise.turn * T_base0_base1.angle() + kTurnFloor;
  return sigma.cwiseAbs2().asDiagonal();
}

MotionFilter::MotionFilter(const MotionNoise& motion, const WheelNoise& wheels, const ImuNoise& imu)
    : motion_(motion), wheels_(wheels), imu_(imu) {
  covariance_.setZero();
  covariance_.block<6, 6>(kTwist, kTwist).diagonal().setConstant(kUnknownTwist * kUnknownTwist);
  covariance_(kScale, kScale) = wheels.scale * wheels.scale;
  covariance_(kYaw, kYaw) = std::pow(wheels.yaw_deg * kDegree, 2);
}

void MotionFilter::predict(Stamp begin, Stamp end, const SensedMotion& motion) {
  ADIT_CHECK(begin < end, "time passes from scan to scan");
  started_ = true;
  const double horizon = to_seconds(std::max(kVelocityHorizon, end_ - begin_));
  begin_ = begin;
  end_ = end;
  path_ = {};
  predict_slip(to_seconds(end - begin));
  if (motion.imu.empty())
    predict_by_twist(to_seconds(end - begin), horizon);
  else
    predict_by_imu(motion);
}

void MotionFilter::predict_slip(double dt) {
  const double kept = std::exp(-dt / wheels_.slip_time);
  slip_ *= kept;
  covariance_.row(kSlip) *= kept;
  covariance_.col(kSlip) *= kept;
  covariance_(kSlip, kSlip) += wheels_.slip_that_lasts * wheels_.slip_that_lasts * (1.0 - kept * kept);
}

void MotionFilter::start_imu(const SensedMotion& motion) {
  has_imu_ = true;
  const ImuMean mean = mean_of(motion.imu);
  const Matrix3 C = motion.T_base_imu.rotation_matrix();
  // What is felt is gravity, but for the bias and for what the robot accelerates.
  felt_.gravity = -kGravity * (C * mean.specific_force).normalized();
  const double sigma = mean.is_still ? imu_.accelerometer_start : kAcceleration;
  covariance_.block<3, 3>(kGravityAt, kGravityAt).diagonal().setConstant(sigma * sigma);
  const Vector3 down = felt_.gravity.normalized();
  const Matrix3 across = Matrix3::Identity() - (1.0 - kGravityLength) * down * down.transpose();
  covariance_.block<3, 3>(kGravityAt, kGravityAt) =
      (across * covariance_.block<3, 3>(kGravityAt, kGravityAt) * across.transpose()).eval();
  if (mean.is_still) felt_.gyroscope_bias = mean.angular_velocity;
  const double gyro = mean.is_still ? kStillTurnRate : imu_.gyroscope_start;
  twist_.tail<3>() = C * (motion.imu.front().angular_velocity - felt_.gyroscope_bias);
  covariance_.middleRows<3>(kTwist + 3).setZero();
  covariance_.middleCols<3>(kTwist + 3).setZero();
  covariance_.block<3, 3>(kTwist + 3, kTwist + 3).diagonal().setConstant(gyro * gyro);
  covariance_.block<3, 3>(kGyro, kGyro).diagonal().setConstant(gyro * gyro);
  covariance_.block<3, 3>(kAccel, kAccel)
      .diagonal()
      .setConstant(imu_.accelerometer_start * imu_.accelerometer_start);
}

void MotionFilter::predict_by_imu(const SensedMotion& motion) {
  if (!has_imu_) start_imu(motion);
  const double dt = to_seconds(end_ - begin_);
  felt_.velocity = twist_.head<3>();
  felt_.turn_rate = twist_.tail<3>();
  const ImuIntegral imu = integrated(motion, begin_, end_, felt_, noise_over(motion.imu, imu_));
  path_ = imu.path;
  T_last_now_ = imu.T_begin_end;
  twist_ = imu.twist;
  // Errors of the motion and of the twist at its end follow from those of the velocity at its begin, of
  // gravity and of the biases.
  Covariance F = Covariance::Identity();
  F.middleRows<6>(kMotion).setZero();
  F.middleRows<6>(kTwist).setZero();
  const auto rows = [&](Eigen::Index to, Eigen::Index from) {
    F.block<6, 6>(to, kTwist) = imu.jacobian.block<6, 6>(from, 0);
    F.block<6, 9>(to, kGravityAt) = imu.jacobian.block<6, 9>(from, 6);
  };
  rows(kMotion, 0);
  rows(kTwist, 6);
  covariance_ = (F * covariance_ * F.transpose()).eval();
  covariance_.block<12, 12>(kMotion, kMotion) += imu.noise;
  covariance_.block<3, 3>(kGyro, kGyro).diagonal().array() += imu_.gyroscope_bias * imu_.gyroscope_bias * dt;
  covariance_.block<3, 3>(kAccel, kAccel).diagonal().array() +=
      imu_.accelerometer_bias * imu_.accelerometer_bias * dt;
}

SweepMotion MotionFilter::sweep() const {
  const Duration duration = end_ - begin_;
  if (path_.poses().empty()) return sweep_of({T_last_now_, duration});
  // The IMU's path, bent evenly to where the motion ends by all that was measured. Offsets count from the
  // end.
  const Vector6 bend = (path_.poses().back().T_world_body.inverse() * T_last_now_).log();
  const Pose T_end_begin = T_last_now_.inverse();
  return {[path = path_, bend, T_end_begin, begin = begin_, end = end_](Duration offset) {
            const Stamp stamp = end + offset;
            const double share = to_seconds(stamp - begin) / to_seconds(end - begin);
            return T_end_begin * path.at(stamp) * Pose::exp(share * bend);
          },
          kSweepRate};
}

std::optional<Vector3> MotionFilter::up() const {
  if (!has_imu_) return {};
  return -felt_.gravity.normalized();
}

void MotionFilter::predict_by_twist(double dt, double horizon) {
  const Vector6 motion = std::min(dt, horizon) * twist_;
  const Vector6 beyond = dt * twist_ - motion;
  T_last_now_ = Pose::exp(motion);
  Vector6 walk;
  walk << Vector3::Constant(motion_.speed), Vector3::Constant(motion_.turn_rate);
  const Matrix6 density = walk.cwiseAbs2().asDiagonal();
  // The motion begins exactly known; the twist's error and its random walk enter it.
  const Matrix6 J = dt * Pose::right_jacobian(motion);
  const Covariance before = covariance_;
  covariance_.middleRows<6>(kMotion) = J * before.middleRows<6>(kTwist);
  covariance_.middleCols<6>(kMotion) = covariance_.middleRows<6>(kMotion).transpose();
  covariance_.block<6, 6>(kMotion, kMotion) = J * before.block<6, 6>(kTwist, kTwist) * J.transpose() +
                                              density * (dt * dt * dt / 3.0) + beyond * beyond.transpose();
  covariance_.block<6, 6>(kTwist, kMotion) += density * (dt * dt / 2.0);
  covariance_.block<6, 6>(kMotion, kTwist) += density * (dt * dt / 2.0);
  covariance_.block<6, 6>(kTwist, kTwist) += density * dt;
}

void MotionFilter::measure(const WheelDelta& wheel) {
  const Vector3& counted = wheel.T_base0_base1.translation();
  const Vector3 sideways = Vector3::UnitZ().cross(counted);
  const Pose T_wheels(wheel.T_base0_base1.rotation(), (1.0 + scale_ + slip_) * counted + yaw_ * sideways);
  const Vector6 residual = (T_wheels.inverse() * T_last_now_).log();
  Rows6 H = Rows6::Zero();
  H.middleCols<6>(kMotion) = Pose::right_jacobian_inverse(residual);
  H.col(kScale).head<3>() = -(T_wheels.rotation().inverse() * counted);
  H.col(kSlip) = H.col(kScale);
  H.col(kYaw).head<3>() = -(T_wheels.rotation().inverse() * sideways);
  Matrix6 innovation = H * covariance_ * H.transpose() + wheel_covariance(wheels_, wheel.T_base0_base1);
  const double sigmas = std::abs(residual[0]) / std::sqrt(innovation(0, 0));
  if (sigmas > kHuber) innovation(0, 0) *= sigmas / kHuber;
  const Columns6 cross = covariance_ * H.transpose();
  Columns6 gain = innovation.ldlt().solve(cross.transpose()).transpose();
  // Scans correct these. Here their derivative, the counted distance, has the noise of the residual in it,
  // and the product of both is not zero in the mean (errors in variables): every scale would come out too
  // small.
  gain.row(kScale).setZero();
  gain.row(kSlip).setZero();
  correct(-gain * residual,
          gain * cross.transpose() + cross * gain.transpose() - gain * innovation * gain.transpose());
}

MotionFilter::Rows6 MotionFilter::jacobian_of_prior() const {
  Rows6 J = Rows6::Zero();
  J.middleCols<6>(kLast) = T_last_now_.inverse().adjoint();
  J.middleCols<6>(kMotion).setIdentity();
  return J;
}

MotionPrior MotionFilter::prior() const {
  const Rows6 J = jacobian_of_prior();
  return {T_ref_last_ * T_last_now_, J * covariance_ * J.transpose()};
}

void MotionFilter::correct(const State& error, const Covariance& known) {
  T_ref_last_ = T_ref_last_ * Pose::exp(error.segment<6>(kLast));
  T_last_now_ = T_last_now_ * Pose::exp(error.segment<6>(kMotion));
  twist_ += error.segment<6>(kTwist);
  scale_ += error[kScale];
  slip_ += error[kSlip];
  yaw_ += error[kYaw];
  felt_.gravity += error.segment<3>(kGravityAt);
  felt_.gyroscope_bias += error.segment<3>(kGyro);
  felt_.accelerometer_bias += error.segment<3>(kAccel);
  const Matrix6 of_path = covariance_.block<6, 6>(kPath, kPath);
  covariance_ -= known;
  covariance_.block<6, 6>(kPath, kPath) = of_path;
  make_symmetric(covariance_);
}

void MotionFilter::registered(const Pose& T_ref_now, const Matrix6& covariance, const Matrix6& onto_fixed,
                              double share_counted) {
  if (!started_) return;
  // What the scan has added to the prior of the pose is passed on to all that is correlated with it.
  const Rows6 J = jacobian_of_prior();
  const MotionPrior before = prior();
  const Eigen::Matrix<double, kSize, 6> gain = before.covariance.ldlt().solve(J * covariance_).transpose();
  const Matrix6 of_prior = covariance * inverse(before.covariance);
  // With P before, C after, s the share and H the scan's whole information, the pose moved by
  // (P^-1 + H)^-1 H times what the scan is off, where C s H times that is what `covariance` stands for.
  const Vector6 moved = (before.T_ref_now.inverse() * T_ref_now).log();
  const Vector6 counted = moved - (1.0 - share_counted) * of_prior * moved;
  correct(gain * counted, gain * (before.covariance - covariance) * gain.transpose());
  // The whole move turns the body, and with it the frame that gravity is held in.
  felt_.gravity = (prior().T_ref_now.inverse() * T_ref_now).rotation().inverse() * felt_.gravity;
  missed();
  extend_path(T_ref_now, onto_fixed);
  T_ref_last_ = Pose();
  // The share of the scan in the pose; its complement is that of the prior.
  const Matrix6 of_scan = Matrix6::Identity() - of_prior;
  covariance_.topRows<6>() = (of_scan * covariance_.topRows<6>()).eval();
  covariance_.leftCols<6>() = (covariance_.leftCols<6>() * of_scan.transpose()).eval();
}

// Along open directions the scan takes the map along with its error, which is that of the path from here on.
void MotionFilter::extend_path(const Pose& T_ref_now, const Matrix6& onto_fixed) {
  Covariance extended = Covariance::Identity();
  extended.block<6, 6>(kPath, kPath) = T_ref_now.inverse().adjoint();
  extended.block<6, 6>(kPath, kLast) = Matrix6::Identity() - onto_fixed;
  const Matrix6 onto_open = extended.block<6, 6>(kPath, kLast);
  const Matrix6 own = onto_open * covariance_.block<6, 6>(kLast, kLast) * onto_open.transpose();
  const Matrix6 shared =
      extended.block<6, 6>(kPath, kPath) * covariance_.block<6, 6>(kPath, kLast) * onto_open.transpose();
  covariance_ = (extended * covariance_ * extended.transpose()).eval();
  // What later steps take back of an error leaves the stretch itself no better known.
  open_drift_ = own + with_sigma_at_least(shared + shared.transpose(), 0.0);
}

void MotionFilter::missed() {
  if (!started_) return;
  const Rows6 J = jacobian_of_prior();
  T_ref_last_ = T_ref_last_ * T_last_now_;
  Covariance carried = Covariance::Identity();
  carried.topRows<6>() = J;
  covariance_ = carried * covariance_ * carried.transpose();
  begin_interval();
}

void MotionFilter::stopped(const Pose& T_last_now) {
  T_last_now_ = T_last_now;
  twist_.setZero();
  covariance_.middleRows<12>(kMotion).setZero();
  covariance_.middleCols<12>(kMotion).setZero();
  missed();
}

void MotionFilter::begin_interval() {
  // Gravity is held in the body's frame, which has moved on.
  const Matrix3 R_t = T_last_now_.rotation_matrix().transpose();
  felt_.gravity = R_t * felt_.gravity;
  Covariance turned = Covariance::Identity();
  turned.block<3, 3>(kGravityAt, kGravityAt) = R_t;
  turned.block<3, 3>(kGravityAt, kMotion + 3) = so3::hat(felt_.gravity);
  covariance_ = (turned * covariance_ * turned.transpose()).eval();
  T_last_now_ = Pose();
  covariance_.middleRows<6>(kMotion).setZero();
  covariance_.middleCols<6>(kMotion).setZero();
}

}  // namespace adit

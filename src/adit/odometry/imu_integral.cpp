// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/imu_integral.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/check.hpp"

namespace adit {
namespace {

using Eigen::Index;

// Where the errors lie: of what is integrated, of the start, and of the answer.
constexpr Index kTurned = 0, kSpeed = 3, kMoved = 6;
constexpr Index kVelocity = 0, kTurnRateAt = 3, kGravityAt = 6, kGyro = 9, kAccel = 12;
constexpr Index kTranslation = 0, kRotation = 3, kVelocityEnd = 6, kTurnRate = 9;

// A robot that stands: gyroscopes of LiDARs have biases and noise below this, driving shakes more.
constexpr double kStillTurn = 0.05;       // rad/s, of the mean
constexpr double kStillTurnNoise = 0.02;  // rad/s, standard deviation
constexpr double kStillForceNoise = 0.2;  // m/s2, standard deviation
constexpr double kStillForce = 0.5;       // m/s2 between the mean's length and gravity

Pose turned(const Vector3& angle) {
  Vector6 v = Vector6::Zero();
  v.tail<3>() = angle;
  return Pose::exp(v);
}

ImuSample between(const ImuSample& a, const ImuSample& b, Stamp stamp) {
  const double s = to_seconds(stamp - a.stamp) / to_seconds(b.stamp - a.stamp);
  return {stamp, a.angular_velocity + s * (b.angular_velocity - a.angular_velocity),
          a.specific_force + s * (b.specific_force - a.specific_force)};
}

// The samples from `begin` to `end`, with one at each.
std::vector<ImuSample> clipped(std::span<const ImuSample> samples, Stamp begin, Stamp end) {
  std::vector<ImuSample> out;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const ImuSample& sample = samples[i];
    if (i > 0 && samples[i - 1].stamp < begin && sample.stamp > begin)
      out.push_back(between(samples[i - 1], sample, begin));
    if (i > 0 && samples[i - 1].stamp < end && sample.stamp > end)
      out.push_back(between(samples[i - 1], sample, end));
    else if (sample.stamp >= begin && sample.stamp <= end)
      out.push_back(sample);
  }
  return out;
}

// Integration of the point at which the IMU sits, in the body's frame at the begin.
class Integration {
 public:
  Integration(const SensedMotion& motion, const ImuStart& start, const ImuNoise& noise)
      : C_(motion.T_base_imu.rotation_matrix()),
        r_(motion.T_base_imu.translation()),
        start_(start),
        noise_(noise),
        position_(r_) {}

  [[nodiscard]] Vector3 turn_rate(const ImuSample& sample) const {
    return C_ * (sample.angular_velocity - start_.gyroscope_bias);
  }

  void begin() {
    velocity_ = start_.velocity + start_.turn_rate.cross(r_);
    jacobian_.block<3, 3>(kSpeed, kVelocity).setIdentity();
    jacobian_.block<3, 3>(kSpeed, kTurnRateAt) = -so3::hat(r_);
  }

  void step(const ImuSample& a, const ImuSample& b) {
    const double dt = to_seconds(b.stamp - a.stamp);
    const Vector3 w = 0.5 * (turn_rate(a) + turn_rate(b));
    const Vector3 f = C_ * (0.5 * (a.specific_force + b.specific_force) - start_.accelerometer_bias);
    const Matrix3 R = (T_turned_ * turned(0.5 * dt * w)).rotation_matrix();
    const Vector3 acceleration = R * f + start_.gravity;
    position_ += dt * velocity_ + 0.5 * dt * dt * acceleration;
    velocity_ += dt * acceleration;
    T_turned_ = T_turned_ * turned(dt * w);
    propagate(dt, w, R, f);
  }

  // Where the body's origin is now.
  [[nodiscard]] Pose pose() const { return {T_turned_.rotation(), position_ - T_turned_.rotation() * r_}; }

  void finish(const ImuSample& last, ImuIntegral& out) const;

 private:
  void propagate(double dt, const Vector3& w, const Matrix3& R, const Vector3& f) {
    Eigen::Matrix<double, 9, 9> F = Eigen::Matrix<double, 9, 9>::Identity();
    F.block<3, 3>(kTurned, kTurned) = turned(-dt * w).rotation_matrix();
    F.block<3, 3>(kSpeed, kTurned) = -dt * R * so3::hat(f);
    F.block<3, 3>(kMoved, kTurned) = -0.5 * dt * dt * R * so3::hat(f);
    F.block<3, 3>(kMoved, kSpeed) = dt * Matrix3::Identity();
    Eigen::Matrix<double, 9, 15> G = Eigen::Matrix<double, 9, 15>::Zero();
    G.block<3, 3>(kTurned, kGyro) = -dt * C_;
    G.block<3, 3>(kSpeed, kGravityAt) = dt * Matrix3::Identity();
    G.block<3, 3>(kSpeed, kAccel) = -dt * R * C_;
    G.block<3, 3>(kMoved, kGravityAt) = 0.5 * dt * dt * Matrix3::Identity();
    G.block<3, 3>(kMoved, kAccel) = -0.5 * dt * dt * R * C_;
    jacobian_ = (F * jacobian_ + G).eval();
    covariance_ = (F * covariance_ * F.transpose()).eval();
    covariance_.block<3, 3>(kTurned, kTurned).diagonal().array() += noise_.gyroscope * noise_.gyroscope * dt;
    const double q = noise_.accelerometer * noise_.accelerometer;
    covariance_.block<3, 3>(kSpeed, kSpeed).diagonal().array() += q * dt;
    covariance_.block<3, 3>(kMoved, kSpeed).diagonal().array() += q * dt * dt / 2.0;
    covariance_.block<3, 3>(kSpeed, kMoved).diagonal().array() += q * dt * dt / 2.0;
    covariance_.block<3, 3>(kMoved, kMoved).diagonal().array() += q * dt * dt * dt / 3.0;
  }

  Matrix3 C_;
  Vector3 r_;
  ImuStart start_;
  ImuNoise noise_;
  Pose T_turned_;
  Vector3 velocity_ = Vector3::Zero();
  Vector3 position_;
  Eigen::Matrix<double, 9, 15> jacobian_ = Eigen::Matrix<double, 9, 15>::Zero();
  Eigen::Matrix<double, 9, 9> covariance_ = Eigen::Matrix<double, 9, 9>::Zero();
};

void Integration::finish(const ImuSample& last, ImuIntegral& out) const {
  const Matrix3 R_t = T_turned_.rotation_matrix().transpose();
  const Vector3 w = turn_rate(last);
  const Vector3 v_imu = R_t * velocity_;
  out.T_begin_end = pose();
  out.twist << v_imu - w.cross(r_), w;
  // From the IMU's point, begin frame, to the body's origin, end frame.
  Eigen::Matrix<double, 12, 9> to_body = Eigen::Matrix<double, 12, 9>::Zero();
  to_body.block<3, 3>(kTranslation, kMoved) = R_t;
  to_body.block<3, 3>(kTranslation, kTurned) = so3::hat(r_);
  to_body.block<3, 3>(kRotation, kTurned).setIdentity();
  to_body.block<3, 3>(kVelocityEnd, kSpeed) = R_t;
  to_body.block<3, 3>(kVelocityEnd, kTurned) = so3::hat(v_imu);
  out.jacobian = to_body * jacobian_;
  out.jacobian.block<3, 3>(kTurnRate, kGyro) -= C_;
  out.jacobian.block<3, 3>(kVelocityEnd, kGyro) -= so3::hat(r_) * C_;
  out.noise = to_body * covariance_ * to_body.transpose();
  // The rate at the end is one sample, whose noise the samples' spacing gives; the velocity of the body's
  // origin is as far off as that turns the lever. What follows begins with both, so that it cancels.
  const double dt = to_seconds(out.path.poses().back().stamp - out.path.poses().front().stamp) /
                    static_cast<double>(out.path.poses().size() - 1);
  const Matrix3 of_sample = noise_.gyroscope * noise_.gyroscope / dt * Matrix3::Identity();
  const Matrix3 lever = so3::hat(r_);
  out.noise.block<3, 3>(kTurnRate, kTurnRate) += of_sample;
  out.noise.block<3, 3>(kVelocityEnd, kTurnRate) += lever * of_sample;
  out.noise.block<3, 3>(kTurnRate, kVelocityEnd) += of_sample * lever.transpose();
  out.noise.block<3, 3>(kVelocityEnd, kVelocityEnd) += lever * of_sample * lever.transpose();
}

}  // namespace

Fields fields_of(ImuNoise& c) {
  return {{"gyroscope", &c.gyroscope, "rad/s/sqrt(Hz)", 1e-7, 1.0,
           "noise density, at least: what samples show counts where it is more"},
          {"accelerometer", &c.accelerometer, "m/s2/sqrt(Hz)", 1e-6, 10.0,
           "noise density, at least: what samples show counts where it is more"},
          {"gyroscope_bias", &c.gyroscope_bias, "rad/s/sqrt(s)", 0.0, 1.0, "random walk of the bias"},
          {"accelerometer_bias", &c.accelerometer_bias, "m/s2/sqrt(s)", 0.0, 10.0, "random walk of the bias"},
          {"gyroscope_start", &c.gyroscope_start, "rad/s", 1e-6, 10.0, "bias when switched on"},
          {"accelerometer_start", &c.accelerometer_start, "m/s2", 1e-6, 10.0, "bias when switched on"}};
}

ImuNoise noise_over(std::span<const ImuSample> samples, const ImuNoise& stated) {
  ImuNoise noise = stated;
  if (samples.size() < 4) return noise;
  double turn2 = 0.0;
  double force2 = 0.0;
  for (std::size_t i = 2; i < samples.size(); ++i) {
    const ImuSample &a = samples[i - 2], &b = samples[i - 1], &c = samples[i];
    turn2 += (a.angular_velocity - 2.0 * b.angular_velocity + c.angular_velocity).squaredNorm();
    force2 += (a.specific_force - 2.0 * b.specific_force + c.specific_force).squaredNorm();
  }
  constexpr double kVarianceOfDifference = 1.0 + 4.0 + 1.0;
  const auto n = static_cast<double>(samples.size());
  const double period = to_seconds(samples.back().stamp - samples.front().stamp) / (n - 1.0);
  if (!(period > 0.0) || !std::isfinite(turn2 + force2)) return noise;
  const double to_density2 = period / (3.0 * (n - 2.0) * kVarianceOfDifference);
  noise.gyroscope = std::max(stated.gyroscope, std::sqrt(turn2 * to_density2));
  noise.accelerometer = std::max(stated.accelerometer, std::sqrt(force2 * to_density2));
  return noise;
}

Pose BodyPath::at(Stamp stamp) const {
  ADIT_CHECK(poses_.size() > 1, "a path has two poses at least");
  auto next = std::ranges::upper_bound(poses_, stamp, {}, &StampedPose::stamp);
  next = std::clamp(next, poses_.begin() + 1, poses_.end() - 1);
  const StampedPose& a = *(next - 1);
  const StampedPose& b = *next;
  const double s = to_seconds(stamp - a.stamp) / to_seconds(b.stamp - a.stamp);
  return a.T_world_body * Pose::exp(s * (a.T_world_body.inverse() * b.T_world_body).log());
}

ImuIntegral integrated(const SensedMotion& motion, Stamp begin, Stamp end, const ImuStart& start,
                       const ImuNoise& noise) {
  const std::vector<ImuSample> samples = clipped(motion.imu, begin, end);
  ADIT_CHECK(samples.size() > 1, "the IMU's samples cover the interval");
  Integration integration(motion, start, noise);
  ImuIntegral out;
  integration.begin();
  out.path.add(samples.front().stamp, Pose());
  for (std::size_t i = 1; i < samples.size(); ++i) {
    integration.step(samples[i - 1], samples[i]);
    out.path.add(samples[i].stamp, integration.pose());
  }
  integration.finish(samples.back(), out);
  return out;
}

ImuMean mean_of(std::span<const ImuSample> samples) {
  ADIT_CHECK(!samples.empty(), "a mean needs a sample");
  ImuMean out;
  Vector3 turn2 = Vector3::Zero();
  Vector3 force2 = Vector3::Zero();
  for (const ImuSample& sample : samples) {
    out.angular_velocity += sample.angular_velocity;
    out.specific_force += sample.specific_force;
    turn2 += sample.angular_velocity.cwiseAbs2();
    force2 += sample.specific_force.cwiseAbs2();
  }
  const auto n = static_cast<double>(samples.size());
  out.angular_velocity /= n;
  out.specific_force /= n;
  const double turn_noise = (turn2 / n - out.angular_velocity.cwiseAbs2()).maxCoeff();
  const double force_noise = (force2 / n - out.specific_force.cwiseAbs2()).maxCoeff();
  out.is_still = out.angular_velocity.norm() < kStillTurn && turn_noise < kStillTurnNoise * kStillTurnNoise &&
                 force_noise < kStillForceNoise * kStillForceNoise &&
                 std::abs(out.specific_force.norm() - kGravity) < kStillForce;
  return out;
}

Pose levelled(const Vector3& up) {
  return {Eigen::Quaterniond::FromTwoVectors(up, Vector3::UnitZ()), Vector3::Zero()};
}

}  // namespace adit

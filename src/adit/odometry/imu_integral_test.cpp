// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/imu_integral.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <span>

#include "adit/core/angles.hpp"
#include "adit/core/check.hpp"
#include "adit/core/decompositions.hpp"
#include "adit/core/rng.hpp"
#include "adit/odometry/motion_filter.hpp"

namespace adit {
namespace {

constexpr double kRate = 200.0;  // Hz
constexpr double kPeriod = 0.1;  // s, from scan to scan
const Vector3 kDown(0.0, 0.0, -kGravity);

// A body that sways, bumps and turns while it drives.
Pose pose_at_time(double t) {
  Vector6 turn = Vector6::Zero();
  turn.tail<3>() << 0.05 * std::sin(4.0 * t), 0.04 * std::cos(3.0 * t), 0.6 * std::sin(0.5 * t);
  const Vector3 place(1.5 * t + 0.1 * std::sin(2.0 * t), 0.3 * std::sin(0.7 * t), 0.05 * std::sin(3.0 * t));
  return {Pose::exp(turn).rotation(), place};
}

Vector3 velocity_at_time(double t) {
  constexpr double h = 1e-4;
  return (pose_at_time(t + h).translation() - pose_at_time(t - h).translation()) / (2.0 * h);
}

// What an IMU with that mount measures.
ImuSample sample_at(double t, const Pose& T_base_imu) {
  constexpr double h = 1e-3;
  const auto imu = [&](double time) { return pose_at_time(time) * T_base_imu; };
  const Vector3 acceleration =
      (imu(t + h).translation() - 2.0 * imu(t).translation() + imu(t - h).translation()) / (h * h);
  return {Stamp() + from_seconds(t), (imu(t - h).inverse() * imu(t + h)).log().tail<3>() / (2.0 * h),
          imu(t).rotation().inverse() * (acceleration - kDown)};
}

SensedMotion sensed(double begin, double end, const Pose& T_base_imu) {
  SensedMotion motion;
  motion.T_base_imu = T_base_imu;
  // The samples are not in step with the scans.
  for (double t = begin - 0.3 / kRate; t < end + 1.0 / kRate; t += 1.0 / kRate)
    motion.imu.push_back(sample_at(t, T_base_imu));
  return motion;
}

ImuStart start_at(double t) {
  const Pose T = pose_at_time(t);
  ImuStart start;
  start.velocity = T.rotation().inverse() * velocity_at_time(t);
  start.turn_rate = sample_at(t, Pose()).angular_velocity;
  start.gravity = T.rotation().inverse() * kDown;
  return start;
}

Pose mount() {
  Vector6 v;
  v << 0.2, -0.1, 0.4, 0.3, -0.2, 1.0;
  return Pose::exp(v);
}

ImuIntegral integral(double begin, double end, const SensedMotion& motion, const ImuStart& start) {
  return integrated(motion, Stamp() + from_seconds(begin), Stamp() + from_seconds(end), start, {});
}

// [motion; twist] of `a` less that of `b`, as errors of the answer.
Eigen::Matrix<double, 12, 1> difference(const ImuIntegral& a, const ImuIntegral& b) {
  Eigen::Matrix<double, 12, 1> out;
  out << (b.T_begin_end.inverse() * a.T_begin_end).log(), a.twist - b.twist;
  return out;
}

void shake(std::vector<ImuSample>& samples, const ImuNoise& noise, Rng& rng) {
  for (ImuSample& sample : samples)
    for (int k = 0; k < 3; ++k) {
      sample.angular_velocity[k] += noise.gyroscope * std::sqrt(kRate) * rng.normal();
      sample.specific_force[k] += noise.accelerometer * std::sqrt(kRate) * rng.normal();
    }
}

ImuNoise times(double factor) {
  ImuNoise noise;
  noise.gyroscope *= factor;
  noise.accelerometer *= factor;
  return noise;
}

TEST(ImuIntegral, GivesTheMotionThatWasMeasured) {
  for (const double begin : {0.37, 2.0, 5.11}) {
    for (const double period : {kPeriod, 1.0}) {
      const double end = begin + period;
      const ImuIntegral imu = integral(begin, end, sensed(begin, end, mount()), start_at(begin));
      const Pose T_true = pose_at_time(begin).inverse() * pose_at_time(end);
      EXPECT_LT((imu.T_begin_end.translation() - T_true.translation()).norm(), 1e-3 * period);
      EXPECT_LT((imu.T_begin_end.inverse() * T_true).angle(), 1e-4 * period);
      EXPECT_LT((imu.twist.head<3>() - start_at(end).velocity).norm(), 2e-3);
      const double middle = begin + 0.4 * period;
      const Pose T_middle = pose_at_time(begin).inverse() * pose_at_time(middle);
      EXPECT_LT((imu.path.at(Stamp() + from_seconds(middle)).inverse() * T_middle).log().norm(), 1e-3);
    }
  }
}

TEST(ImuIntegral, ItsDerivativesAreThoseOfDifferences) {
  const double begin = 1.2;
  const double end = begin + kPeriod;
  const SensedMotion motion = sensed(begin, end, mount());
  const ImuStart start = start_at(begin);
  const ImuIntegral at = integral(begin, end, motion, start);
  for (int k = 0; k < 15; ++k) {
    constexpr double h = 1e-5;
    const auto moved = [&](double by) {
      ImuStart s = start;
      (k < 3    ? s.velocity[k]
       : k < 6  ? s.turn_rate[k - 3]
       : k < 9  ? s.gravity[k - 6]
       : k < 12 ? s.gyroscope_bias[k - 9]
                : s.accelerometer_bias[k - 12]) += by;
      return integral(begin, end, motion, s);
    };
    const Eigen::Matrix<double, 12, 1> column = difference(moved(h), moved(-h)) / (2.0 * h);
    EXPECT_LT((column - at.jacobian.col(k)).norm(), 4e-3 * std::max(0.1, column.norm())) << k;
  }
}

TEST(ImuIntegral, ItsNoiseIsThatOfNoisySamples) {
  const double begin = 1.2;
  const double end = begin + kPeriod;
  const SensedMotion clean = sensed(begin, end, mount());
  const ImuStart start = start_at(begin);
  const ImuIntegral truth = integral(begin, end, clean, start);
  const ImuNoise noise;
  Rng rng(7);
  double nees = 0.0;
  constexpr int kRuns = 400;
  for (int run = 0; run < kRuns; ++run) {
    SensedMotion noisy = clean;
    shake(noisy.imu, noise, rng);
    const Vector6 error = difference(integral(begin, end, noisy, start), truth).head<6>();
    nees += error.dot(inverse(Matrix6(truth.noise.topLeftCorner<6, 6>())) * error) / 6.0;
  }
  EXPECT_NEAR(nees / kRuns, 1.0, 0.15);
}

TEST(ImuMean, TellsStandingFromDriving) {
  SensedMotion standing;
  for (int i = 0; i < 50; ++i)
    standing.imu.push_back({Stamp() + from_seconds(i / kRate), Vector3(0.01, 0.0, 0.0), -kDown});
  EXPECT_TRUE(mean_of(standing.imu).is_still);
  EXPECT_FALSE(mean_of(sensed(1.0, 1.5, Pose()).imu).is_still);
  EXPECT_THROW((void)mean_of({}), ContractViolation);
}

TEST(Levelled, TakesUpToZ) {
  for (const Vector3& up : {Vector3(0.1, 0.2, 9.7), Vector3(9.8, 0.0, 0.1), Vector3(0.0, 0.0, -9.8)})
    EXPECT_LT((levelled(up).rotation() * up.normalized() - Vector3::UnitZ()).norm(), 1e-9);
}

TEST(NoiseOver, IsThatOfTheSamplesWhereTheyShakeMoreThanStated) {
  Rng rng(5);
  std::vector<ImuSample> samples = sensed(1.0, 3.0, Pose()).imu;
  shake(samples, times(8.0), rng);
  const ImuNoise found = noise_over(samples, {});
  EXPECT_NEAR(found.gyroscope, times(8.0).gyroscope, 0.1 * times(8.0).gyroscope);
  EXPECT_NEAR(found.accelerometer, times(8.0).accelerometer, 0.1 * times(8.0).accelerometer);
  EXPECT_EQ(found.gyroscope_bias, ImuNoise().gyroscope_bias);
}

TEST(NoiseOver, MotionIsNoNoise) {
  for (const double begin : {0.4, 1.0, 7.0}) {
    const ImuNoise found = noise_over(sensed(begin, begin + kPeriod, mount()).imu, {});
    EXPECT_EQ(found.gyroscope, ImuNoise().gyroscope);
    EXPECT_EQ(found.accelerometer, ImuNoise().accelerometer);
  }
}

TEST(NoiseOver, ThreeSamplesSayNothing) {
  Rng rng(5);
  std::vector<ImuSample> samples = sensed(1.0, 2.0, Pose()).imu;
  shake(samples, times(100.0), rng);
  for (const std::size_t n : {0U, 1U, 2U, 3U})
    EXPECT_EQ(noise_over(std::span(samples).first(n), {}).gyroscope, ImuNoise().gyroscope);
  EXPECT_GT(noise_over(std::span(samples).first(4), {}).gyroscope, ImuNoise().gyroscope);
  samples[2].angular_velocity.x() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(noise_over(samples, {}).gyroscope, ImuNoise().gyroscope);
  samples.assign(5, samples.front());
  EXPECT_EQ(noise_over(samples, {}).accelerometer, ImuNoise().accelerometer);
}

// Scans that fix the pose show what the IMU is off by: biases and gravity, from a moving start, and the
// prediction is as good as it says.
// The filter is told what a data sheet states, whatever the noise is.
struct Calibrated {
  double nees = 0.0;          // mean, per direction: 1 where the prediction is as good as it says
  double longest_miss = 0.0;  // of a pose predicted over one interval, metres and radians
  double tilt_deg = 0.0;      // of gravity at the end
};
Calibrated drive_with(const ImuNoise& noise) {
  Rng rng(3);
  const Vector3 gyroscope_bias(0.01, -0.015, 0.005);
  const Vector3 accelerometer_bias(0.1, -0.05, 0.12);
  MotionFilter filter({}, {}, {});
  Calibrated out;
  int count = 0;
  for (int i = 1; i < 400; ++i) {
    const double begin = 0.5 + kPeriod * (i - 1);
    const double end = begin + kPeriod;
    SensedMotion motion = sensed(begin, end, mount());
    shake(motion.imu, noise, rng);
    for (ImuSample& sample : motion.imu) {
      sample.angular_velocity += gyroscope_bias;
      sample.specific_force += accelerometer_bias;
    }
    filter.predict(Stamp() + from_seconds(begin), Stamp() + from_seconds(end), motion);
    const Pose T_true = pose_at_time(begin).inverse() * pose_at_time(end);
    const MotionPrior prior = filter.prior();
    const Vector6 error = (prior.T_ref_now.inverse() * T_true).log();
    if (i > 100) {
      out.nees += error.dot(inverse(prior.covariance) * error) / 6.0;
      ++count;
      out.longest_miss = std::max(out.longest_miss, error.norm());
    }
    filter.registered(T_true, Matrix6::Identity() * 1e-10);
  }
  out.nees /= count;
  const Vector3 up = pose_at_time(0.5 + kPeriod * 399).rotation().inverse() * Vector3::UnitZ();
  out.tilt_deg = std::acos(std::min(1.0, filter.up()->dot(up))) / kDegree;
  return out;
}

TEST(MotionFilterWithImu, FindsBiasesAndGravityOnTheMove) {
  const Calibrated calm = drive_with({});
  EXPECT_LT(calm.longest_miss, 2e-3);
  EXPECT_GT(calm.nees, 0.4);
  EXPECT_LT(calm.nees, 1.6);
  EXPECT_LT(calm.tilt_deg, 0.5);
}

// A filter that believed the data sheet would take itself for twenty times as good as it is.
TEST(MotionFilterWithImu, KnowsHowMuchItShakes) {
  const Calibrated shaken = drive_with(times(20.0));
  EXPECT_GT(shaken.nees, 0.4);
  EXPECT_LT(shaken.nees, 1.6);
  EXPECT_LT(shaken.tilt_deg, 1.5);
}

// A drive of a minute, in which scans say where the robot is and little of what they say counts (as in
// plane_icp), with wheels that drive one degree askew. Returns by how much gravity is off then, degrees.
double tilt_after_a_minute(const WheelNoise& noise, const Vector3& gyroscope_bias) {
  constexpr double kShare = 0.05;
  constexpr double kAskew = 1.0 * kDegree;
  constexpr int kScans = 600;
  const Matrix6 counted = Matrix6::Identity() * 1e4;
  MotionFilter filter({}, noise, {});
  for (int i = 0; i < kScans; ++i) {
    const double begin = kPeriod * i;
    const double end = begin + kPeriod;
    const Pose T_true = pose_at_time(begin).inverse() * pose_at_time(end);
    SensedMotion motion = sensed(begin, end, Pose());
    for (ImuSample& sample : motion.imu) sample.angular_velocity += gyroscope_bias;
    const Pose T_forward = Pose::planar(0, 0, -kAskew);
    motion.wheel = {.duration = from_seconds(kPeriod),
                    .T_base0_base1 = {T_true.rotation(), T_forward * T_true.translation()}};
    filter.predict(Stamp() + from_seconds(begin), Stamp() + from_seconds(end), motion);
    filter.measure(*motion.wheel);
    const MotionPrior prior = filter.prior();
    const Matrix6 before = inverse(prior.covariance);
    const Matrix6 weighed = counted / kShare;
    const Vector6 off = (prior.T_ref_now.inverse() * T_true).log();
    const Vector6 step = inverse(Matrix6(before + weighed)) * weighed * off;
    filter.registered(prior.T_ref_now * Pose::exp(step), inverse(Matrix6(before + counted)),
                      Matrix6::Identity(), kShare);
  }
  const Vector3 up = pose_at_time(kPeriod * kScans).rotation().inverse() * Vector3::UnitZ();
  return std::acos(std::min(1.0, filter.up()->dot(up))) / kDegree;
}

TEST(MotionFilterWithImu, WheelsThatDriveAskewTiltNothing) {
  EXPECT_LT(tilt_after_a_minute({}, Vector3::Zero()), 0.3);
  EXPECT_GT(tilt_after_a_minute({.yaw_deg = 0.0}, Vector3::Zero()),
            2.0 * tilt_after_a_minute({}, Vector3::Zero()));
}

TEST(MotionFilterWithImu, GravityTurnsAsFarAsScansSay) {
  EXPECT_LT(tilt_after_a_minute({}, Vector3(0.02, -0.02, 0.02)), 0.5);
}

}  // namespace
}  // namespace adit

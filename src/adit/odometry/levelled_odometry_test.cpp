// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/levelled_odometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "adit/core/angles.hpp"
#include "adit/odometry/imu_integral.hpp"

namespace adit {
namespace {

constexpr double kStep = 0.1;  // seconds from scan to scan
constexpr int kSamples = 10;   // of the IMU in that time
const Pose kBaseImu(Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Vector3::UnitZ())), {0.2, 0.1, 0.5});

/// Where the robot is after `seconds`, on a level floor: 150 m ahead, to the left, 90 m more, at a speed that
/// swings about 1.3 m/s.
Pose T_world_base(double seconds) {
  const double s = 1.3 * seconds + 0.8 * std::sin(0.5 * seconds);
  constexpr double kRadius = 6.0;
  constexpr double kStraight = 150.0;
  constexpr double kBend = 0.5 * std::numbers::pi * kRadius;
  if (s < kStraight) return Pose::planar(s, 0.0, 0.0);
  if (s < kStraight + kBend) {
    const double turned = (s - kStraight) / kRadius;
    return Pose::planar(kStraight + kRadius * std::sin(turned), kRadius * (1.0 - std::cos(turned)), turned);
  }
  return Pose::planar(kStraight + kRadius, kRadius + (s - kStraight - kBend), 0.5 * std::numbers::pi);
}
constexpr int kScans = 1900;

/// What an IMU feels there, by differences of its own path, with a constant offset and what shakes it.
ImuSample felt(double seconds, const Vector3& offset, std::mt19937& random) {
  constexpr double h = 0.01;
  const auto imu = [](double t) { return T_world_base(t) * kBaseImu.translation(); };
  const Vector3 a = (imu(seconds + h) - 2.0 * imu(seconds) + imu(seconds - h)) / (h * h);
  std::normal_distribution<double> shakes(0.0, 0.5);
  const Vector3 noise(shakes(random), shakes(random), shakes(random));
  const Pose T_world_imu = T_world_base(seconds) * kBaseImu;
  ImuSample sample;
  sample.stamp = Stamp{static_cast<std::int64_t>(std::llround(1e9 * (seconds + 10.0)))};
  sample.specific_force =
      T_world_imu.rotation().inverse() * (a + kGravity * Vector3::UnitZ()) + offset + noise;
  return sample;
}

/// Follows the robot and turns by `drift_deg` about its axes with each metre.
class Drifting : public Odometry {
 public:
  explicit Drifting(const Vector3& drift_deg) : drift_(kDegree * drift_deg) {}
  OdometryStep register_scan(const Scan& scan, const SensedMotion& /*motion*/) override {
    const Pose T_world_now = T_world_base(to_seconds(scan.stamp - Stamp{0}) - 10.0);
    if (T_world_last_) {
      const Pose T_last_now = T_world_last_->inverse() * T_world_now;
      Vector6 drifted = Vector6::Zero();
      drifted.tail<3>() = T_last_now.translation().norm() * drift_;
      step_.T_odom_base = step_.T_odom_base * T_last_now * Pose::exp(drifted);
    }
    T_world_last_ = T_world_now;
    step_.stamp = scan.stamp;
    return step_;
  }
  [[nodiscard]] const PointCloud& cloud_of_last_scan() const override { return cloud_; }

 private:
  Vector3 drift_;
  std::optional<Pose> T_world_last_;
  OdometryStep step_;
  PointCloud cloud_;
};

struct Drive {
  Vector3 drift_deg = {-0.002, 0.008, 0.0};  ///< A metre.
  Vector3 offset = {0.15, -0.1, 0.05};       ///< m/s^2, IMU frame.
  int no_imu_from = kScans;
  int no_imu_to = kScans;
};

struct Errors {
  double tilt_deg = 0.0;  ///< The largest about the true attitude.
  double height_m = 0.0;  ///< The largest.
};

Errors errors_of(Odometry& odometry, const Drive& drive) {
  std::mt19937 random(7);
  Errors errors;
  for (int k = 0; k < kScans; ++k) {
    const double seconds = kStep * k;
    Scan scan;
    scan.stamp = Stamp{static_cast<std::int64_t>(std::llround(1e9 * (seconds + 10.0)))};
    SensedMotion motion;
    motion.T_base_imu = kBaseImu;
    if (k < drive.no_imu_from || k >= drive.no_imu_to)
      for (int i = 0; i <= kSamples; ++i)
        motion.imu.push_back(felt(seconds - kStep + kStep * i / kSamples, drive.offset, random));
    const Pose T = odometry.register_scan(scan, motion).T_odom_base;
    const Vector3 up = T.rotation() * Vector3::UnitZ();
    errors.tilt_deg = std::max(errors.tilt_deg, std::acos(std::min(1.0, up.z())) / kDegree);
    errors.height_m = std::max(errors.height_m, std::abs(T.translation().z()));
  }
  return errors;
}

Errors levelled_errors(const Drive& drive, const TiltNoise& noise = {}) {
  LevelledOdometry odometry(std::make_unique<Drifting>(drive.drift_deg), noise);
  return errors_of(odometry, drive);
}

TEST(LevelledOdometry, TakesOutMuchOfWhatRollAndPitchDrift) {
  const Drive drive;
  Drifting alone(drive.drift_deg);
  const Errors before = errors_of(alone, drive);
  EXPECT_GT(before.tilt_deg, 1.0);
  EXPECT_GT(before.height_m, 1.0);
  const Errors after = levelled_errors(drive);
  EXPECT_LT(after.tilt_deg, 0.65 * before.tilt_deg);
  EXPECT_LT(after.height_m, 0.7 * before.height_m);
}

TEST(LevelledOdometry, AnOffsetOfTheAccelerometerIsNoDrift) {
  Drive drive;
  drive.drift_deg.setZero();
  for (const double offset : {-0.3, 0.0, 0.3}) {
    drive.offset = {offset, offset, 0.0};
    const Errors errors = levelled_errors(drive);
    EXPECT_LT(errors.tilt_deg, 0.4) << offset;
    EXPECT_LT(errors.height_m, 0.4) << offset;
  }
}

TEST(LevelledOdometry, GoesOnAfterAnImuWasSilent) {
  Drive drive;
  drive.no_imu_from = 500;
  drive.no_imu_to = 900;
  EXPECT_LT(levelled_errors(drive).tilt_deg, 1.0);  // 1.5 without
}

TEST(LevelledOdometry, AnImuThatSendsZerosTakesNothingOut) {
  LevelledOdometry levelled(std::make_unique<Drifting>(Vector3(0.0, 0.01, 0.0)), TiltNoise());
  Drifting alone({0.0, 0.01, 0.0});
  for (int k = 0; k < 300; ++k) {
    Scan scan;
    scan.stamp = Stamp{static_cast<std::int64_t>(1e8) * (100 + k)};
    SensedMotion motion;
    motion.imu = {{scan.stamp - std::chrono::milliseconds(100)}, {scan.stamp}};
    const Pose difference = alone.register_scan(scan, {}).T_odom_base.inverse() *
                            levelled.register_scan(scan, motion).T_odom_base;
    EXPECT_LT(difference.log().norm(), 1e-9);
  }
}

TEST(LevelledOdometry, WithoutAnImuEveryBitIsThatOfTheOdometry) {
  Drifting alone({0.01, 0.01, 0.01});
  LevelledOdometry levelled(std::make_unique<Drifting>(Vector3(0.01, 0.01, 0.01)), TiltNoise());
  for (int k = 0; k < 300; ++k) {
    Scan scan;
    scan.stamp = Stamp{static_cast<std::int64_t>(1e8) * (100 + k)};
    const Pose expected = alone.register_scan(scan, {}).T_odom_base;
    const Pose found = levelled.register_scan(scan, {}).T_odom_base;
    EXPECT_EQ(found.translation(), expected.translation());
    EXPECT_EQ(found.rotation().coeffs(), expected.rotation().coeffs());
  }
}

TEST(LevelledOdometry, WithoutDriftNothingIsTakenOut) {
  const Errors errors = levelled_errors({{0.0, 0.0, 0.0}}, {.drift_deg = 0.0});
  EXPECT_LT(errors.tilt_deg, 1e-5);
  EXPECT_LT(errors.height_m, 1e-6);
}

TEST(TiltFilter, ABlowIsNoTilt) {
  TiltFilter filter({});
  for (int i = 0; i < 20; ++i) filter.measure(kGravity * Vector3::UnitZ(), Matrix3::Identity(), 1.0, 1.0);
  filter.measure({5.0, 0.0, kGravity}, Matrix3::Identity(), 1.0, 1.0);
  EXPECT_LT(filter.R_start_now().angularDistance(Eigen::Quaterniond::Identity()), 1e-9);
  for (int i = 0; i < 200; ++i)
    filter.measure({0.1, 0.0, kGravity}, Matrix3::Identity(), 1.0, 1.0);  // 0.6 degrees
  // Up leans forward now: it is turned back about y.
  const Eigen::AngleAxisd turn(filter.R_start_now());
  EXPECT_GT(turn.angle(), 0.25 * kDegree);
  EXPECT_LT(turn.angle(), 0.6 * kDegree);
  EXPECT_LT((filter.R_start_now() * Vector3(0.1, 0.0, kGravity).normalized()).x(), 0.1 / kGravity);
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/levelled_odometry.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "adit/core/angles.hpp"
#include "adit/core/rng.hpp"
#include "adit/odometry/imu_integral.hpp"

namespace adit {
namespace {

constexpr double kStep = 0.1;  // seconds from scan to scan
constexpr int kSamples = 10;   // of the IMU in that time
const Pose kBaseImu(Eigen::Quaterniond(Eigen::AngleAxisd(0.6, Vector3(0.3, 0.8, 0.5).normalized())),
                    {0.2, 0.1, 0.5});

/// Where the robot is after `seconds`, on a level floor: 150 m ahead, to the left, 90 m more, at a speed that
/// swings about 1.3 m/s.
Pose T_world_base(double seconds) {
  const double s = 1.3 * seconds + 2.4 * std::sin(0.5 * seconds);
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
ImuSample felt(double seconds, const Vector3& offset, Rng& random) {
  constexpr double h = 0.01;
  const auto imu = [](double t) { return T_world_base(t) * kBaseImu.translation(); };
  const Vector3 a = (imu(seconds + h) - 2.0 * imu(seconds) + imu(seconds - h)) / (h * h);
  Vector3 noise;
  for (double& component : noise) component = 0.5 * random.normal();
  const Pose T_world_imu = T_world_base(seconds) * kBaseImu;
  ImuSample sample;
  sample.stamp = Stamp{static_cast<std::int64_t>(std::llround(1e9 * (seconds + 10.0)))};
  sample.specific_force =
      T_world_imu.rotation().inverse() * (a + kGravity * Vector3::UnitZ()) + offset + noise;
  return sample;
}

struct Drive {
  Vector3 drift_deg = {-0.002, 0.008, 0.0};  ///< A metre.
  Vector3 offset = {0.15, -0.1, 0.05};       ///< m/s^2, IMU frame.
  int no_imu_from = kScans;
  int no_imu_to = kScans;
  int jump_at = kScans;  ///< The ten scans before are not registered.
  double jump_deg = 0.0;
  Eigen::Quaterniond R_odom_world = Eigen::Quaterniond::Identity();  ///< At the start.
};

/// Follows the robot and turns by `drift_deg` about its axes with each metre.
class Drifting : public Odometry {
 public:
  explicit Drifting(Drive drive) : drift_(kDegree * drive.drift_deg), drive_(std::move(drive)) {
    step_.T_odom_base = Pose(drive_.R_odom_world, Vector3::Zero());
  }
  explicit Drifting(const Vector3& drift_deg) : Drifting(Drive{drift_deg}) {}
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
    step_.status =
        num_ < drive_.jump_at && num_ + 10 >= drive_.jump_at ? StepStatus::too_few_points : StepStatus::ok;
    if (num_++ == drive_.jump_at)
      step_.T_odom_base =
          step_.T_odom_base *
          Pose(Eigen::Quaterniond(Eigen::AngleAxisd(drive_.jump_deg * kDegree, Vector3::UnitY())),
               Vector3::Zero());
    return step_;
  }
  [[nodiscard]] const PointCloud& cloud_of_last_scan() const override { return cloud_; }

 private:
  Vector3 drift_;
  Drive drive_;
  int num_ = 0;
  std::optional<Pose> T_world_last_;
  OdometryStep step_;
  PointCloud cloud_;
};

struct Errors {
  double tilt_deg = 0.0;  ///< The largest about the true attitude.
  double height_m = 0.0;  ///< The largest.
  double tilt_at_end_deg = 0.0;
};

Errors errors_of(Odometry& odometry, const Drive& drive) {
  Rng random(7);
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
    const Pose T_odom_base = odometry.register_scan(scan, motion).T_odom_base;
    const Pose T = Pose(drive.R_odom_world.inverse(), Vector3::Zero()) * T_odom_base;
    const Vector3 up = T.rotation() * Vector3::UnitZ();
    errors.tilt_at_end_deg = std::acos(std::min(1.0, up.z())) / kDegree;
    errors.tilt_deg = std::max(errors.tilt_deg, errors.tilt_at_end_deg);
    errors.height_m = std::max(errors.height_m, std::abs(T.translation().z()));
  }
  return errors;
}

Errors levelled_errors(const Drive& drive, const TiltNoise& noise = {}) {
  LevelledOdometry odometry(std::make_unique<Drifting>(drive), noise);
  return errors_of(odometry, drive);
}

TEST(LevelledOdometry, TakesOutMuchOfWhatRollAndPitchDrift) {
  const Drive drive;
  Drifting alone(drive);
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

TEST(LevelledOdometry, ThatTheOdometryBeginsTiltedChangesNothing) {
  Drive drive;
  const Errors upright = levelled_errors(drive);
  drive.R_odom_world = Eigen::AngleAxisd(0.4, Vector3(1.0, -0.7, 0.3).normalized());
  const Errors tilted = levelled_errors(drive);
  EXPECT_NEAR(tilted.tilt_deg, upright.tilt_deg, 0.01);
  EXPECT_NEAR(tilted.height_m, upright.height_m, 0.05);
}

TEST(LevelledOdometry, AJumpWhereNoScanWasRegisteredIsTakenOut) {
  for (const double jump_deg : {6.0, 20.0}) {
    Drive drive;
    drive.drift_deg.setZero();
    drive.jump_at = 600;
    drive.jump_deg = jump_deg;
    EXPECT_LT(levelled_errors(drive).tilt_at_end_deg, 1.0) << jump_deg;
  }
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

}  // namespace
}  // namespace adit

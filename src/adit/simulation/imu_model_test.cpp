// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/imu_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "adit/core/angles.hpp"
#include "adit/simulation/smooth_motion.hpp"
#include "adit/simulation/trajectory.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

ImuConfig perfect_imu() { return imu_preset("perfect").value(); }

const Pose kMount(Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vector3(1, -2, 3).normalized())),
                  Vector3(0.3, -0.2, 0.9));

Trajectory standing_for(const Pose& T_world_base, double seconds) {
  Trajectory truth;
  for (int i = 0; i <= std::lround(100.0 * seconds); ++i)
    truth.push_back({Stamp{5} + from_seconds(0.01 * i), T_world_base});
  return truth;
}

/// A drive with curves, speeding up and braking over a floor with waves.
const Trajectory& wavy_drive() {
  static const Trajectory truth = [] {
    const Eigen::AlignedBox2d area(Eigen::Vector2d(-10, -10), Eigen::Vector2d(60, 60));
    const TriangleMesh mesh =
        test::floor_of(area, 0.25, [](double x, double y) { return 0.1 * std::sin(0.8 * x + 0.3 * y); });
    const Route route{"robot_0", 1.8, {{0, 0, 0}, {20, 0, 0}, {20, 20, 0}, {30, 25, 0}}};
    return drive(Raycaster::build(mesh, EdgeRule::watertight).value(), route, DriveConfig(), Stamp{}).value();
  }();
  return truth;
}

/// Dead reckoning from the true state at sample `first`: between two samples rate and force are their means.
struct Reckoned {
  Pose T_world_imu;
  Vector3 velocity;
};
Reckoned integrate(const std::vector<ImuSample>& imu, std::size_t first, std::size_t last, Reckoned state) {
  for (std::size_t i = first + 1; i <= last; ++i) {
    const double dt = to_seconds(imu[i].stamp - imu[i - 1].stamp);
    const Vector3 rate = 0.5 * (imu[i].angular_velocity + imu[i - 1].angular_velocity);
    const Eigen::Quaterniond before = state.T_world_imu.rotation();
    const Eigen::Quaterniond after = (before * so3::exp(dt * rate)).normalized();
    const Vector3 acceleration = 0.5 * (before * imu[i - 1].specific_force + after * imu[i].specific_force) -
                                 kStandardGravity * Vector3::UnitZ();
    const Vector3 position =
        state.T_world_imu.translation() + dt * state.velocity + 0.5 * dt * dt * acceleration;
    state.velocity += dt * acceleration;
    state.T_world_imu = Pose(after, position);
  }
  return state;
}

TEST(ImuModel, IntegratingPerfectSamplesGivesTheTrueTrajectory) {
  const Trajectory& truth = wavy_drive();
  const std::vector<ImuSample> imu = imu_samples(truth, kMount, perfect_imu(), 1);
  const Pose start = truth.front().T_world_body * kMount;
  ASSERT_GT(truth.back().stamp.seconds(), 20.0);
  double largest = 0.0;
  Reckoned state{start, Vector3::Zero()};
  for (std::size_t i = 200; i + 1 < imu.size(); i += 200) {
    state = integrate(imu, i - 200, i, state);
    const Pose T_world_imu = pose_at(truth, imu[i].stamp).value() * kMount;
    const Pose error = T_world_imu.inverse() * state.T_world_imu;
    EXPECT_LT(error.angle(), 2e-4) << i;
    if (i <= 2000) largest = std::max(largest, error.translation().norm());
  }
  EXPECT_LT(largest, 0.005);  // after up to ten seconds
}

TEST(ImuModel, PerfectSamplesOverASecondAreTrueWithinTenthsOfAMillimetre) {
  const Trajectory& truth = wavy_drive();
  const std::vector<ImuSample> imu = imu_samples(truth, kMount, perfect_imu(), 1);
  const SmoothMotion motion(truth, kMount);
  for (std::size_t i = 0; i + 201 < imu.size(); i += 200) {
    const Kinematics now = motion.at(imu[i].stamp);
    const Reckoned state = integrate(imu, i, i + 200, {now.T_world_body, now.velocity});
    const Pose T_world_imu = pose_at(truth, imu[i + 200].stamp).value() * kMount;
    EXPECT_LT((state.T_world_imu.translation() - T_world_imu.translation()).norm(), 5e-4) << i;
  }
}

TEST(SmoothMotion, PassesThroughTheTrajectoryAndItsDerivativesAreThoseOfThePoses) {
  const Trajectory& truth = wavy_drive();
  const SmoothMotion motion(truth, kMount);
  for (std::size_t i = 0; i < truth.size(); i += 7) {
    const Pose T_world_imu = truth[i].T_world_body * kMount;
    const Pose error = T_world_imu.inverse() * motion.at(truth[i].stamp).T_world_body;
    EXPECT_LT(error.translation().norm(), 5e-4);
    EXPECT_LT(error.angle(), 1e-3);
  }
  const Duration h = std::chrono::microseconds(100);
  const double dt = to_seconds(h);
  for (Stamp stamp = truth.front().stamp + h; stamp < truth.back().stamp;
       stamp = stamp + from_seconds(0.0933)) {
    const Kinematics now = motion.at(stamp);
    const Kinematics before = motion.at(stamp - h);
    const Kinematics after = motion.at(stamp + h);
    const Vector3 velocity =
        (after.T_world_body.translation() - before.T_world_body.translation()) / (2.0 * dt);
    EXPECT_LT((velocity - now.velocity).norm(), 1e-6);
    EXPECT_LT(((after.velocity - before.velocity) / (2.0 * dt) - now.acceleration).norm(), 1e-2);
    const Vector3 turned = (before.T_world_body.inverse() * after.T_world_body).log().tail<3>();
    EXPECT_LT((turned / (2.0 * dt) - now.angular_velocity).norm(), 1e-5);
  }
}

TEST(ImuModel, AtRestItFeelsGravityInItsOwnFrame) {
  const Pose T_world_base(Eigen::Quaterniond(Eigen::AngleAxisd(0.4, Vector3(2, 1, 0.5).normalized())),
                          Vector3(3, 4, 5));
  const std::vector<ImuSample> imu = imu_samples(standing_for(T_world_base, 2.0), kMount, perfect_imu(), 1);
  const Vector3 up = (T_world_base * kMount).rotation().conjugate() * Vector3(0, 0, kStandardGravity);
  EXPECT_EQ(imu.size(), 401U);
  for (const ImuSample& sample : imu) {
    EXPECT_LT((sample.specific_force - up).norm(), 1e-9);
    EXPECT_LT(sample.angular_velocity.norm(), 1e-9);
  }
  const ImuSample level = imu_samples(standing_for(Pose(), 1.0), Pose(), perfect_imu(), 1).front();
  EXPECT_LT((level.specific_force - Vector3(0, 0, 9.80665)).norm(), 1e-9);
}

TEST(ImuModel, OnACircleItFeelsTheLeverArm) {
  Trajectory truth;
  const double rate = 0.5;
  for (int i = 0; i <= 1000; ++i)
    truth.push_back({Stamp{} + from_seconds(0.01 * i), Pose::planar(0, 0, rate * 0.01 * i)});
  const Pose arm = Pose::translation_of(2.0, 0, 0);
  const ImuSample sample = imu_samples(truth, arm, perfect_imu(), 1)[1000];
  EXPECT_NEAR(sample.specific_force.x(), -rate * rate * 2.0, 1e-4);  // towards the centre
  EXPECT_NEAR(sample.specific_force.y(), 0.0, 1e-4);
  EXPECT_NEAR(sample.angular_velocity.z(), rate, 1e-5);
}

struct Statistics {
  Vector3 mean = Vector3::Zero();
  Vector3 variance = Vector3::Zero();
};
template <class Member>
Statistics statistics_of(const std::vector<ImuSample>& imu, Member member) {
  Statistics s;
  for (const ImuSample& sample : imu) s.mean += member(sample) / static_cast<double>(imu.size());
  for (const ImuSample& sample : imu)
    s.variance += (member(sample) - s.mean).cwiseAbs2() / static_cast<double>(imu.size());
  return s;
}
Vector3 rate_of(const ImuSample& sample) { return sample.angular_velocity; }
Vector3 force_of(const ImuSample& sample) { return sample.specific_force; }

TEST(ImuModel, WhiteNoiseHasTheDensityOfItsField) {
  ImuConfig c = perfect_imu();
  c.gyro_noise_deg = 0.015;
  c.accel_noise = 2.3e-3;
  const std::vector<ImuSample> imu = imu_samples(standing_for(Pose(), 100.0), Pose(), c, 3);
  const Statistics rate = statistics_of(imu, rate_of);
  const Statistics force = statistics_of(imu, force_of);
  const ImuCovariance stated = covariance_of(c);
  const double rate_variance = 200.0 * std::pow(0.015 * kDegree, 2);
  EXPECT_NEAR(stated.angular_velocity(1, 1), rate_variance, 1e-6 * rate_variance);
  for (int axis = 0; axis < 3; ++axis) {  // 20,000 samples: a variance within 5 %, a mean within 5 sigma
    EXPECT_NEAR(rate.variance[axis] / stated.angular_velocity(axis, axis), 1.0, 0.05);
    EXPECT_NEAR(force.variance[axis] / stated.specific_force(axis, axis), 1.0, 0.05);
    EXPECT_LT(std::abs(rate.mean[axis]), 5.0 * std::sqrt(rate_variance / 20000.0));
  }
}

TEST(ImuModel, BiasesDifferFromSensorToSensorAndWalk) {
  ImuConfig c = perfect_imu();
  c.gyro_bias_deg = 1.0;
  c.gyro_walk_deg = 0.1;
  double start = 0.0;
  double walk = 0.0;
  constexpr int kSensors = 100;
  for (std::uint64_t seed = 0; seed < kSensors; ++seed) {
    const std::vector<ImuSample> imu = imu_samples(standing_for(Pose(), 4.0), Pose(), c, seed);
    start += imu.front().angular_velocity.squaredNorm() / (3.0 * kSensors);
    walk += (imu.back().angular_velocity - imu.front().angular_velocity).squaredNorm() / (3.0 * kSensors);
  }
  EXPECT_NEAR(std::sqrt(start) / kDegree, 1.0, 0.15);
  EXPECT_NEAR(std::sqrt(walk) / kDegree, 0.1 * std::sqrt(4.0), 0.03);
}

TEST(ImuModel, RangesCutOff) {
  ImuConfig c = perfect_imu();
  c.accel_max = 10.0;
  c.accel_bias = 5.0;
  c.gyro_max_deg = 10.0;
  c.gyro_bias_deg = 50.0;
  for (const ImuSample& sample : imu_samples(standing_for(Pose(), 1.0), Pose(), c, 2)) {
    EXPECT_LE(sample.specific_force.cwiseAbs().maxCoeff(), 10.0);
    EXPECT_EQ(sample.angular_velocity.cwiseAbs().maxCoeff(), 10.0 * kDegree);
  }
}

TEST(ImuModel, VibrationGrowsWithSpeed) {
  ImuConfig c = perfect_imu();
  c.vibration = 1.0;
  const Trajectory& truth = wavy_drive();
  const std::vector<ImuSample> calm = imu_samples(truth, kMount, perfect_imu(), 1);
  const std::vector<ImuSample> shaken = imu_samples(truth, kMount, c, 1);
  EXPECT_LT((shaken[100].specific_force - calm[100].specific_force).norm(), 1e-6);  // it stands
  double sum = 0.0;
  for (std::size_t i = 1000; i < 2000; ++i)
    sum += (shaken[i].specific_force - calm[i].specific_force).squaredNorm() / 3000.0;
  EXPECT_NEAR(std::sqrt(sum), 1.8, 0.3);
}

TEST(ImuModel, CoversTheDriveExceptWhereItIsSilent) {
  ImuConfig c;
  c.faults = "silent 3:4.5";
  const Trajectory& truth = wavy_drive();
  const std::vector<ImuSample> imu = imu_samples(truth, kMount, c, 1);
  EXPECT_EQ(imu.front().stamp, truth.front().stamp);
  EXPECT_GE(imu.back().stamp, truth.back().stamp);
  const auto after = std::ranges::lower_bound(imu, Stamp{} + from_seconds(3.0), {}, &ImuSample::stamp);
  EXPECT_EQ(after->stamp, Stamp{} + from_seconds(4.5));
  EXPECT_EQ((after - 1)->stamp, Stamp{} + from_seconds(2.99));
  // What is left is what would have been measured anyway.
  const std::vector<ImuSample> whole = imu_samples(truth, kMount, ImuConfig(), 1);
  EXPECT_EQ(whole.back().specific_force, imu.back().specific_force);
  ASSERT_EQ(imu_faults(c, Stamp{}).size(), 1U);
  EXPECT_EQ(imu_faults(c, Stamp{})[0].sensor, "imu");
}

TEST(ImuModel, TheSeedDecides) {
  const std::vector<ImuSample> once = imu_samples(wavy_drive(), kMount, ImuConfig(), 1);
  const std::vector<ImuSample> again = imu_samples(wavy_drive(), kMount, ImuConfig(), 1);
  const std::vector<ImuSample> other = imu_samples(wavy_drive(), kMount, ImuConfig(), 2);
  for (std::size_t i = 0; i < once.size(); ++i) {
    ASSERT_EQ(once[i].angular_velocity, again[i].angular_velocity);
    ASSERT_EQ(once[i].specific_force, again[i].specific_force);
  }
  EXPECT_NE(once[5].specific_force, other[5].specific_force);
}

TEST(ImuModel, PresetsAreSoundAndUnknownOnesRefused) {
  for (const std::string& name : imu_presets()) {
    EXPECT_TRUE(check_imu(imu_preset(name).value())) << name;
    EXPECT_EQ(imu_preset(name)->name, name);
  }
  EXPECT_EQ(ImuConfig().name, imu_presets().front());
  EXPECT_NE(imu_preset("none").error().message.find("icm-20948, bmi088"), std::string::npos);
  ImuConfig c;
  c.faults = "slip 1:2";
  EXPECT_FALSE(check_imu(c));
  c.faults = "";
  c.rate_hz = 0.0;
  EXPECT_FALSE(check_imu(c));
}

}  // namespace
}  // namespace adit

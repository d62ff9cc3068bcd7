// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Simulated recordings, spoilt in every manner that the checks of sensors know, and clean ones.
#include "adit/robot/sensor_checks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "adit/core/angles.hpp"
#include "adit/core/rng.hpp"
#include "adit/simulation/scenario.hpp"
#include "support/findings.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

using test::expect_finding;
using test::only_finding;

/// A drive of a minute and a half around a hall, with curves to both sides. Without scans, as this is about
/// wheels and IMU alone.
Recording drive_with(const ScenarioConfig& config) {
  World world;
  world.name = "hall";
  world.mesh = test::room({-10, -30, 0}, {80, 30, 6});
  Route route{"robot_0", 1.8, {}};
  for (int i = 0; i <= 70; ++i) route.waypoints.emplace_back(i, 8.0 * std::sin(0.25 * i), 0.0);
  for (int i = 0; i <= 60; ++i) route.waypoints.emplace_back(70 - i, 15.0 + 5.0 * std::cos(0.3 * i), 0.0);
  world.routes = {route};
  Recording recording = simulate(world, config).value().front();
  recording.scan_stamps.clear();
  return recording;
}

const Recording& clean_drive() {
  static const Recording recording = drive_with({});
  return recording;
}

Recording drive_with_faults(const std::string& faults) {
  ScenarioConfig config;
  config.wheels.faults = faults;
  return drive_with(config);
}

template <class Change>
Recording with_imu(const Change& change) {
  Recording recording = clean_drive();
  for (ImuSample& sample : recording.imu) change(sample);
  return recording;
}

TEST(SensorChecks, FindNothingInCleanRecordings) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    for (const std::string& imu : imu_presets()) {
      if (imu == "perfect") continue;  // states a covariance of zero
      ScenarioConfig config;
      config.seed = seed;
      config.imu = imu_preset(imu).value();
      if (seed % 2 == 0) config.imu.vibration = config.imu.vibration_deg = 2.0;
      config.imu.accel_max = 80.0;
      Recording recording = drive_with(config);
      const std::size_t num_samples = recording.imu.size();
      const std::vector<SensorFinding> findings = use_sound_sensors(recording);
      EXPECT_TRUE(findings.empty()) << imu << ": " << findings.front().sentence;
      EXPECT_EQ(recording.imu.size(), num_samples);
      EXPECT_FALSE(recording.wheel.empty());
    }
  }
}

TEST(SensorChecks, FindNothingWhereASensorIsMissing) {
  for (const bool has_wheels : {false, true}) {
    Recording recording = clean_drive();
    has_wheels ? recording.imu.clear() : recording.wheel.clear();
    EXPECT_TRUE(use_sound_sensors(recording).empty());
  }
  Recording none = clean_drive();
  none.imu.clear();
  none.wheel.clear();
  EXPECT_TRUE(use_sound_sensors(none).empty());
}

// Of what IMUs measure.
void expect_imu_of(const Recording& recording, const Recording& expected) {
  ASSERT_EQ(recording.imu.size(), expected.imu.size());
  for (std::size_t i = 0; i < recording.imu.size(); i += 50) {
    EXPECT_LT((recording.imu[i].specific_force - expected.imu[i].specific_force).norm(), 1e-9);
    EXPECT_LT((recording.imu[i].angular_velocity - expected.imu[i].angular_velocity).norm(), 1e-9);
  }
  const ImuCovariance& covariance = recording.imu_covariance;
  EXPECT_LT((covariance.specific_force - expected.imu_covariance.specific_force).norm(), 1e-9);
  EXPECT_LT((covariance.angular_velocity - expected.imu_covariance.angular_velocity).norm(), 1e-9);
}

TEST(SensorChecks, AnImuInGIsConverted) {
  Recording recording = with_imu([](ImuSample& s) { s.specific_force /= kStandardGravity; });
  recording.imu_covariance.specific_force /= kStandardGravity * kStandardGravity;
  const SensorFinding found = only_finding(recording);
  EXPECT_EQ(found.finding, Finding::imu_in_g);
  EXPECT_EQ(found.consequence, Consequence::repaired);
  EXPECT_NE(found.sentence.find("multiplied by 9.80665"), std::string::npos) << found.sentence;
  expect_imu_of(recording, clean_drive());
}

TEST(SensorChecks, AnImuInAnotherUnitIsLeftOut) {
  expect_finding(with_imu([](ImuSample& s) { s.specific_force *= 100.0; }), Finding::imu_wrong_unit,
                 Consequence::left_out, "check the driver's unit");
}

TEST(SensorChecks, AnImuWithoutGravityIsLeftOut) {
  const Vector3 gravity(0, 0, kStandardGravity);
  expect_finding(with_imu([&](ImuSample& s) { s.specific_force -= gravity; }), Finding::imu_without_gravity,
                 Consequence::left_out, "no gravity");
}

TEST(SensorChecks, ABeginWithoutGravityIsLeftOut) {
  Recording recording = clean_drive();
  const std::size_t num_samples = recording.imu.size();
  for (std::size_t i = 0; i < 70; ++i) recording.imu[i].specific_force.setZero();
  const SensorFinding found = only_finding(recording);
  EXPECT_EQ(found.finding, Finding::imu_without_gravity);
  EXPECT_EQ(found.consequence, Consequence::repaired);
  EXPECT_NE(found.sentence.find("until 0.70 s"), std::string::npos) << found.sentence;
  EXPECT_EQ(recording.imu.size(), num_samples - 70);
}

TEST(SensorChecks, RatesInDegreesAreConvertedWithAndWithoutWheels) {
  for (const std::string imu : {"icm-20948", "adis16470"}) {
    ScenarioConfig config;
    config.imu = imu_preset(imu).value();
    config.wheels.on = imu == "icm-20948";
    const Recording sound = drive_with(config);
    Recording recording = sound;
    for (ImuSample& sample : recording.imu) sample.angular_velocity /= kDegree;
    recording.imu_covariance.angular_velocity /= kDegree * kDegree;
    const SensorFinding found = only_finding(recording);
    EXPECT_EQ(found.finding, Finding::imu_in_degrees);
    EXPECT_EQ(found.consequence, Consequence::repaired);
    EXPECT_NE(found.sentence.find("degrees per second and converted"), std::string::npos) << found.sentence;
    expect_imu_of(recording, sound);
  }
}

TEST(SensorChecks, RatesInNoUnitAtAllAreLeftOut) {
  expect_finding(with_imu([](ImuSample& s) { s.angular_velocity *= 1e4; }), Finding::imu_wrong_rates,
                 Consequence::left_out, "check the driver's unit");
  Rng rng(1);  // radians of a gyroscope that shakes are no degrees
  expect_finding(with_imu([&](ImuSample& s) {
                   s.angular_velocity += 8.0 * Vector3(rng.normal(), rng.normal(), rng.normal());
                 }),
                 Finding::imu_wrong_rates, Consequence::left_out, "check the driver's unit");
}

TEST(SensorChecks, AMountThatDisagreesWithGravityIsFound) {
  Recording upside_down = clean_drive();
  upside_down.T_base_imu =
      upside_down.T_base_imu * Pose::exp((Vector6() << 0, 0, 0, 180 * kDegree, 0, 0).finished());
  expect_finding(upside_down, Finding::imu_wrong_axes, Consequence::left_out, "along minus z (up)");
  Recording on_its_side = clean_drive();
  on_its_side.T_base_imu =
      on_its_side.T_base_imu * Pose::exp((Vector6() << 0, 0, 0, 0, 90 * kDegree, 0).finished());
  expect_finding(on_its_side, Finding::imu_wrong_axes, Consequence::left_out, "along x (forward)");
  // An IMU that is mounted that way and says so is fine.
  ScenarioConfig config;
  config.imu.mount_roll_deg = 180.0;
  Recording stated = drive_with(config);
  EXPECT_TRUE(use_sound_sensors(stated).empty());
}

TEST(SensorChecks, SaturationIsFound) {
  ScenarioConfig config;
  config.imu.vibration = 2.0;
  config.imu.accel_max = 14.0;
  expect_finding(drive_with(config), Finding::imu_saturated, Consequence::left_out, "cut off at 14 m/s^2");
  config.imu.accel_max = 20.0;
  expect_finding(drive_with(config), Finding::imu_saturated, Consequence::noted, "cut off at 20 m/s^2");
}

TEST(SensorChecks, GapsOfTheImuAreNamed) {
  ScenarioConfig config;
  config.imu.faults = "silent 10:12, silent 20:20.5";
  expect_finding(drive_with(config), Finding::imu_gaps, Consequence::noted,
                 "silent 2 times for more than 0.1 s, longest for 2.01 s at 9.99 s");
}

TEST(SensorChecks, CovariancesThatCannotBeAreReplaced) {
  const auto with_covariance = [](const Matrix3& covariance) {
    Recording recording = clean_drive();
    recording.imu_covariance.angular_velocity = covariance;
    return recording;
  };
  expect_finding(with_covariance(Matrix3::Zero()), Finding::imu_bad_covariance, Consequence::repaired,
                 "not stated");
  expect_finding(with_covariance(Matrix3::Identity() * 1e6), Finding::imu_bad_covariance,
                 Consequence::repaired, "huge");
  expect_finding(with_covariance(Vector3(1e-4, -1e-4, 1e-4).asDiagonal()), Finding::imu_bad_covariance,
                 Consequence::repaired, "not positive definite");
  Recording recording = with_covariance(Matrix3::Constant(std::nan("")));
  EXPECT_EQ(only_finding(recording).finding, Finding::imu_bad_covariance);
  EXPECT_TRUE(recording.imu_covariance.angular_velocity.isZero());
  EXPECT_FALSE(recording.imu.empty());
}

Recording wheels_with(const WheelConfig& wheels) {
  ScenarioConfig config;
  config.wheels = wheels;
  return drive_with(config);
}

TEST(SensorChecks, WheelsOfTheWrongSignAreLeftOut) {
  WheelConfig wheels;
  wheels.sign = WheelSign::swapped;
  expect_finding(wheels_with(wheels), Finding::wheels_reversed, Consequence::left_out,
                 "turn against the gyroscope");
  wheels.sign = WheelSign::reversed;
  expect_finding(wheels_with(wheels), Finding::wheels_reversed, Consequence::left_out,
                 "count backward as forward and turn against");
}

TEST(SensorChecks, WheelsThatTurnTenPercentTooFarAreNoted) {
  WheelConfig wheels;
  wheels.scale = 1.1;
  expect_finding(wheels_with(wheels), Finding::wheels_wrong_scale, Consequence::noted, "% too far");
  wheels.scale = 0.9;
  expect_finding(wheels_with(wheels), Finding::wheels_wrong_scale, Consequence::noted, "% too little");
}

TEST(SensorChecks, LateWheelsAreMovedByWhatTheyAreLate) {
  for (const double late : {0.1, -0.1, 0.25}) {
    WheelConfig wheels;
    wheels.time_offset = late;
    Recording recording = wheels_with(wheels);
    const Stamp first = recording.wheel.front().stamp;
    const SensorFinding found = only_finding(recording);
    EXPECT_EQ(found.finding, Finding::wheels_late) << found.sentence;
    EXPECT_NEAR(to_seconds(first - recording.wheel.front().stamp), late, 0.01) << found.sentence;
  }
}

TEST(SensorChecks, FrozenWheelsAreLeftOutWhileTheyAreFrozen) {
  for (const char* fault : {"freeze 20:24", "lift 20:24"}) {
    Recording recording = drive_with_faults(fault);
    const SensorFinding found = only_finding(recording);
    EXPECT_EQ(found.finding, Finding::wheels_frozen) << found.sentence;
    EXPECT_NE(found.sentence.find("1 times, first at"), std::string::npos) << found.sentence;
    const auto after =
        std::ranges::upper_bound(recording.wheel, Stamp{} + from_seconds(20.1), {}, &StampedPose::stamp);
    EXPECT_GT(after->stamp, Stamp{} + from_seconds(23.9));
  }
}

TEST(SensorChecks, JumpsAreTakenOut) {
  Recording recording = drive_with_faults("jump 30:1000 2.5");
  const SensorFinding found = only_finding(recording);
  EXPECT_EQ(found.finding, Finding::wheels_jump) << found.sentence;
  EXPECT_EQ(found.consequence, Consequence::repaired);
  EXPECT_NE(found.sentence.find("1 times, first by 2.5"), std::string::npos) << found.sentence;
  const Pose error = recording.wheel.back().T_world_body.inverse() * clean_drive().wheel.back().T_world_body;
  EXPECT_LT(error.translation().norm(), 0.05);
}

// Messages in pairs, each pair stamped as it arrives.
TEST(SensorChecks, StampsThatCrowdAreNoJumps) {
  Recording recording = clean_drive();
  for (std::size_t i = 1; i < recording.wheel.size(); i += 8)
    recording.wheel[i].stamp = recording.wheel[i - 1].stamp + std::chrono::microseconds(500);
  const Pose last = recording.wheel.back().T_world_body;
  EXPECT_TRUE(use_sound_sensors(recording).empty());
  EXPECT_EQ(recording.wheel.back().T_world_body.matrix(), last.matrix());
}

/// A scan every 0.1 s, by a clock that is `apart` from that of wheels and IMU.
Recording scanned(double apart) {
  Recording recording = clean_drive();
  for (Stamp stamp = recording.wheel.front().stamp; stamp < recording.wheel.back().stamp;
       stamp = stamp + std::chrono::milliseconds(100))
    recording.scan_stamps.push_back(stamp + from_seconds(apart));
  return recording;
}

TEST(SensorChecks, SensorsThatMeasuredAtNoScanAreLeftOut) {
  Recording recording = scanned(0.0);
  EXPECT_TRUE(use_sound_sensors(recording).empty());
  recording = scanned(1.7e9);
  const std::vector<SensorFinding> findings = use_sound_sensors(recording);
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].finding, Finding::imu_silent);
  EXPECT_EQ(findings[1].finding, Finding::wheels_silent);
  for (const SensorFinding& finding : findings) {
    EXPECT_EQ(finding.consequence, Consequence::left_out);
    EXPECT_NE(finding.sentence.find("one clock"), std::string::npos) << finding.sentence;
  }
  EXPECT_TRUE(recording.imu.empty());
  EXPECT_TRUE(recording.wheel.empty());
}

TEST(SensorChecks, SensorsThatMeasuredAtFewScansAreNoted) {
  const Recording all = scanned(0.0);
  Recording recording = scanned(0.7 * to_seconds(all.scan_stamps.back() - all.scan_stamps.front()));
  const std::vector<SensorFinding> findings = use_sound_sensors(recording);
  ASSERT_EQ(findings.size(), 2U);
  for (const SensorFinding& finding : findings) EXPECT_EQ(finding.consequence, Consequence::noted);
  EXPECT_EQ(recording.imu.size(), all.imu.size());
  EXPECT_EQ(recording.wheel.size(), all.wheel.size());
}

TEST(SensorChecks, SilenceAndSlipOfWheelsAreLeftToTheOdometry) {
  Recording recording = drive_with_faults("silent 10:20, slip 30:33 1.0");
  const std::size_t num_poses = recording.wheel.size();
  EXPECT_TRUE(use_sound_sensors(recording).empty());
  EXPECT_EQ(recording.wheel.size(), num_poses);
}

}  // namespace
}  // namespace adit

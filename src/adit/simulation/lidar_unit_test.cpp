// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/lidar_unit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "adit/core/angles.hpp"
#include "adit/core/rng.hpp"
#include "adit/simulation/lidar_model.hpp"
#include "adit/simulation/scenario.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

constexpr double kWall = 8.0;

LidarConfig flawless() {
  LidarConfig c = lidar_preset("os2-32").value();
  c.noise_near = c.noise_far = 0.0;
  c.dropout_start_deg = 89.99;
  c.dropout_end_deg = 90.0;
  return c;
}

LidarUnit with_rings(std::vector<double> LidarUnit::*errors, double error) {
  LidarUnit unit;
  (unit.*errors).assign(num_rings(flawless()), error);
  return unit;
}

/// In the middle of a cube, all of whose walls are kWall away.
PointCloud seen_by(const LidarUnit& unit, double seconds = 0.0) {
  static const Raycaster cube =
      Raycaster::build(test::room(Vector3::Constant(-kWall), Vector3::Constant(kWall))).value();
  return cast_scan(cube, flawless(), {Pose(), Pose(), Stamp{} + from_seconds(seconds), 1}, unit).cloud;
}

/// By how much each range is beyond the wall in its direction.
std::vector<double> range_errors(const PointCloud& cloud) {
  std::vector<double> errors;
  for (const Eigen::Vector3f& p : cloud.points) {
    const Vector3 direction = p.cast<double>().normalized();
    errors.push_back(p.cast<double>().norm() - kWall / direction.cwiseAbs().maxCoeff());
  }
  return errors;
}

double largest(const std::vector<double>& errors) {
  return std::ranges::max(errors, {}, [](double error) { return std::abs(error); });
}

TEST(LidarUnit, WithoutErrorsChangesNoBit) {
  const PointCloud plain = seen_by({});
  const LidarUnit drawn = draw_lidar_unit({}, num_rings(flawless()), 3, 7);
  EXPECT_EQ(plain.points, seen_by(drawn).points);
  EXPECT_EQ(drawn.wheels_late.count(), 0);
  EXPECT_LT(drawn.T_nominal_true.log().norm(), 1e-12);
}

TEST(LidarUnit, ABiasLengthensEveryRange) {
  LidarUnit unit;
  unit.range_bias = 0.03;
  for (const double error : range_errors(seen_by(unit))) EXPECT_NEAR(error, 0.03, 1e-5);
}

TEST(LidarUnit, EachRingHasItsOwn) {
  LidarUnit unit = with_rings(&LidarUnit::ring_range, 0.0);
  unit.ring_range[5] = -0.01;
  const std::vector<double> errors = range_errors(seen_by(unit));
  ASSERT_EQ(errors.size() % unit.ring_range.size(), 0U);
  for (std::size_t i = 0; i < errors.size(); ++i)
    EXPECT_NEAR(errors[i], i % unit.ring_range.size() == 5 ? -0.01 : 0.0, 1e-5);
}

TEST(LidarUnit, RangesWalkWithIncidence) {
  LidarUnit unit;
  unit.incidence_walk = 0.02;
  const PointCloud cloud = seen_by(unit);
  const std::vector<double> errors = range_errors(cloud);
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double cosine = cloud.points[i].cast<double>().normalized().cwiseAbs().maxCoeff();
    EXPECT_NEAR(errors[i], 0.02 * std::pow((1.0 - cosine) / (1.0 - std::cos(80.0 * kDegree)), 2), 1e-5);
  }
  EXPECT_GT(largest(errors), 2e-3);  // up to 56 degrees here
}

TEST(LidarUnit, WarmsUp) {
  LidarUnit unit;
  unit.warm_up_drift = 0.01;
  unit.warm_up_s = 100.0;
  EXPECT_LT(largest(range_errors(seen_by(unit, 0.0))), 1e-5);
  EXPECT_NEAR(range_errors(seen_by(unit, 100.0)).front(), 0.01 * (1.0 - std::exp(-1.0)), 1e-5);
  EXPECT_NEAR(range_errors(seen_by(unit, 2000.0)).front(), 0.01, 1e-5);
  unit.on_before_s = 60.0;
  EXPECT_NEAR(range_errors(seen_by(unit, 40.0)).front(), 0.01 * (1.0 - std::exp(-1.0)), 1e-5);
}

// It reports the direction of its drawing and the range of where it looks.
TEST(LidarUnit, ARingThatLooksElsewhereReportsTheRangeFromThere) {
  const double off = 0.5 * kDegree;
  const PointCloud reported = seen_by({});
  for (const auto errors : {&LidarUnit::ring_elevation, &LidarUnit::ring_azimuth}) {
    const PointCloud cloud = seen_by(with_rings(errors, off));
    ASSERT_EQ(cloud.size(), reported.size());
    for (std::size_t i = 0; i < cloud.size(); i += 13) {
      const Vector3 p = cloud.points[i].cast<double>();
      ASSERT_LT((p.normalized() - reported.points[i].cast<double>().normalized()).norm(), 1e-5);
      const bool up = errors == &LidarUnit::ring_elevation;
      const double azimuth = std::atan2(p.y(), p.x()) + (up ? 0.0 : off);
      const double elevation = std::asin(p.normalized().z()) + (up ? off : 0.0);
      const Vector3 looks(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                          std::sin(elevation));
      EXPECT_NEAR(p.norm(), kWall / looks.cwiseAbs().maxCoeff(), 1e-4);
    }
  }
}

TEST(LidarUnit, FalseReturnsLieBeforeTheWallInTheirShare) {
  LidarUnit unit;
  unit.false_returns = 0.01;
  const std::vector<double> errors = range_errors(seen_by(unit));
  const auto num_false =
      static_cast<double>(std::ranges::count_if(errors, [](double e) { return e < -1e-4; }));
  const double expected = 0.01 * static_cast<double>(errors.size());
  EXPECT_NEAR(num_false, expected, 5.0 * std::sqrt(expected));
  EXPECT_LT(std::ranges::max(errors), 1e-4);
}

TEST(LidarUnit, DrawsHaveTheirSpreadAndNoneIsFartherThanTwoOfIt) {
  LidarErrorConfig config;
  config.range_bias = 0.015;
  config.ring_bias = 0.008;
  double of_units = 0.0;
  double of_rings = 0.0;
  constexpr int kUnits = 500;
  constexpr std::size_t kRings = 16;
  for (int robot = 0; robot < kUnits; ++robot) {
    const LidarUnit unit = draw_lidar_unit(config, kRings, 0, static_cast<std::uint64_t>(robot));
    ASSERT_LE(std::abs(unit.range_bias), 0.03);
    of_units += unit.range_bias * unit.range_bias / kUnits;
    ASSERT_EQ(unit.ring_range.size(), kRings);
    for (const double bias : unit.ring_range) of_rings += bias * bias / (kUnits * kRings);
  }
  constexpr double kCutAtTwoSigma = 0.880;  // standard deviation of a normal variable within two sigma
  EXPECT_NEAR(std::sqrt(of_units), kCutAtTwoSigma * 0.015, 0.001);
  EXPECT_NEAR(std::sqrt(of_rings), kCutAtTwoSigma * 0.008, 0.0003);
}

TEST(LidarUnit, OneMountInTenIsCareless) {
  const LidarErrorConfig config = field_lidar_errors();
  constexpr int kUnits = 2000;
  int num_beyond = 0;
  double most = 0.0;
  for (int robot = 0; robot < kUnits; ++robot) {
    const Vector3 turn =
        draw_lidar_unit(config, 0, 0, static_cast<std::uint64_t>(robot)).T_nominal_true.log().tail<3>() /
        kDegree;
    num_beyond += turn.cwiseAbs().maxCoeff() > 2.0 * config.mount_deg ? 1 : 0;
    most = std::max(most, turn.cwiseAbs().maxCoeff());
  }
  constexpr double kBeyondOnSomeAxis = 0.9;  // of normal draws, 0.6 sigma on one axis of three
  EXPECT_NEAR(num_beyond / static_cast<double>(kUnits), config.careless * kBeyondOnSomeAxis, 0.02);
  EXPECT_GT(most, 1.5);
  EXPECT_LT(most, 2.05);
}

TEST(LidarUnit, OpposedUnitsAreTwoSigmaApart) {
  LidarErrorConfig config = field_lidar_errors();
  config.opposed = true;
  const LidarUnit even = draw_lidar_unit(config, 0, 0, 1);
  const LidarUnit odd = draw_lidar_unit(config, 0, 1, 2);
  EXPECT_DOUBLE_EQ(even.range_bias - odd.range_bias, 2.0 * config.range_bias);
  EXPECT_DOUBLE_EQ(even.incidence_walk - odd.incidence_walk, 2.0 * config.incidence_walk);
}

World cube_to_cross() {
  World world;
  world.name = "cube";
  world.mesh = test::room({-10.0, -5.0, 0.0}, {20.0, 5.0, 4.0});
  world.routes = {{"robot_0", 1.5, {{-5, 0, 0}, {10, 0, 0}}}, {"robot_1", 1.5, {{10, 2, 0}, {-5, 2, 0}}}};
  return world;
}

TEST(LidarUnit, RecordingsStateTheNominalMountAndScansComeFromTheTrueOne) {
  ScenarioConfig config;
  config.lidar = flawless();
  config.lidar_errors.mount = 0.5;
  const Recording recording = simulate(cube_to_cross(), config)->front();
  EXPECT_EQ(recording.T_base_lidar.translation(), Vector3(0.0, 0.0, config.lidar.mount_height));
  const LidarUnit unit = draw_lidar_unit(config.lidar_errors, num_rings(config.lidar), 0,
                                         mix64(mix64(config.seed, 0), 0x756e6974));
  const double true_height = config.lidar.mount_height + unit.T_nominal_true.translation().z();
  ASSERT_GT(std::abs(true_height - config.lidar.mount_height), 0.05);
  const Scan scan = recording.read_scan(0).value();
  double lowest = 0.0;  // the robot stands at first
  for (const Eigen::Vector3f& p : scan.cloud.points) lowest = std::min(lowest, static_cast<double>(p.z()));
  EXPECT_NEAR(lowest, -true_height, 1e-3);
}

TEST(LidarUnit, ClocksShiftWheelsAndImuAndStampsJitterInOrder) {
  ScenarioConfig config;
  config.lidar = flawless();
  const Recording plain = simulate(cube_to_cross(), config)->front();
  config.lidar_errors.clock_s = 0.01;
  config.lidar_errors.jitter_s = 0.001;
  const Recording shifted = simulate(cube_to_cross(), config)->front();
  const Duration wheels = shifted.wheel.back().stamp - plain.wheel.back().stamp;
  const Duration imu = shifted.imu.back().stamp - plain.imu.back().stamp;
  EXPECT_NE(wheels, imu);
  EXPECT_LE(std::abs(to_seconds(wheels)), 0.02);
  EXPECT_LE(std::abs(to_seconds(imu)), 0.02);
  // Early clocks end before the last sweep does, which is then left out.
  ASSERT_LE(shifted.num_scans(), plain.num_scans());
  ASSERT_GE(shifted.num_scans() + 1, plain.num_scans());
  double of_stamps = 0.0;
  for (std::size_t i = 0; i < shifted.num_scans(); ++i) {
    const double off = to_seconds(shifted.scan_stamps[i] - plain.scan_stamps[i]);
    EXPECT_LE(std::abs(off), 0.002 + 1e-9);
    of_stamps += off * off / static_cast<double>(plain.num_scans());
    EXPECT_EQ(shifted.read_scan(i)->stamp, shifted.scan_stamps[i]);
  }
  EXPECT_NEAR(std::sqrt(of_stamps), 0.001, 0.0003);
}

TEST(LidarUnit, AFleetHasItsSensorsInTurn) {
  ScenarioConfig config;
  config.lidars = "vlp-16, os1-64";
  const std::vector<Recording> recordings = simulate(cube_to_cross(), config).value();
  EXPECT_EQ(recordings[0].lidar, "vlp-16");
  EXPECT_EQ(recordings[1].lidar, "os1-64");
  config.lidars = "vlp-61";
  const auto unknown = simulate(cube_to_cross(), config);
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().message.find("vlp-61"), std::string::npos);
}

}  // namespace
}  // namespace adit

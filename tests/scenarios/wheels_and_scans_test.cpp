// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Simulated robots without an IMU, whose wheels are spoilt in every manner that scans tell, and sound ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "adit/core/parallel.hpp"
#include "adit/evaluation/ate.hpp"
#include "adit/robot/sensor_checks.hpp"
#include "adit/simulation/scenario.hpp"
#include "adit/slam/mapping.hpp"
#include "support/findings.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

using test::expect_finding;
using test::only_finding;

/// Twice a figure of eight in a hall, whose walls are all in sight.
Recording hall_drive(const WheelConfig& wheels, const std::string& lidar = "os2-32", std::uint64_t seed = 1) {
  World world;
  world.name = "hall";
  world.mesh = test::room({-15, -10, 0}, {17, 11, 6});
  Route route{"robot_0", 1.5, {}};
  for (int i = 0; i <= 120; ++i)
    route.waypoints.emplace_back(10.0 * std::sin(0.105 * i), 5.0 * std::sin(0.21 * i), 0.0);
  world.routes = {route};
  ScenarioConfig config;
  config.lidar = lidar_preset(lidar).value();
  config.wheels = wheels;
  config.imu.on = false;
  config.seed = seed;
  return simulate(world, config).value().front();
}

Recording hall_drive(const Recording& drive, const WheelCovariance& covariance) {
  Recording recording = drive;
  recording.wheel_covariance = covariance;
  return recording;
}

TEST(WheelsAndScans, SoundWheelsOfSeveralSensorsGiveNoFinding) {
  std::uint64_t seed = 0;
  for (const std::string lidar : {"os2-32", "vlp-16", "livox-mid-360"}) {
    Recording recording = hall_drive({}, lidar, ++seed);
    const std::size_t num_poses = recording.wheel.size();
    const std::vector<SensorFinding> findings = use_sound_sensors(recording);
    EXPECT_TRUE(findings.empty()) << lidar << ": " << findings.front().sentence;
    EXPECT_EQ(recording.wheel.size(), num_poses);
  }
}

TEST(WheelsAndScans, WheelsOfTheWrongSignAreLeftOut) {
  WheelConfig wheels;
  wheels.sign = WheelSign::swapped;
  expect_finding(hall_drive(wheels), Finding::wheels_reversed, Consequence::left_out,
                 "as they turn against the scans; check the wiring");
  wheels.sign = WheelSign::reversed;
  expect_finding(hall_drive(wheels), Finding::wheels_reversed, Consequence::left_out,
                 "count backward as forward and turn against the scans");
}

TEST(WheelsAndScans, AWrongScaleIsNoted) {
  WheelConfig wheels;
  wheels.scale = 1.1;
  expect_finding(hall_drive(wheels), Finding::wheels_wrong_scale, Consequence::noted, "and they drive 1");
  wheels.scale = 0.9;
  expect_finding(hall_drive(wheels), Finding::wheels_wrong_scale, Consequence::noted,
                 "% too little by the scans");
}

TEST(WheelsAndScans, LateWheelsAreMovedByWhatTheyAreLate) {
  for (const auto& [lidar, late] : {std::pair("os2-32", 0.1), std::pair("vlp-16", -0.1)}) {
    WheelConfig wheels;
    wheels.time_offset = late;
    Recording recording = hall_drive(wheels, lidar);
    const Stamp first = recording.wheel.front().stamp;
    const SensorFinding found = only_finding(recording);
    EXPECT_EQ(found.finding, Finding::wheels_late) << found.sentence;
    EXPECT_NEAR(to_seconds(first - recording.wheel.front().stamp), late, 0.015) << found.sentence;
  }
}

/// Largest error of the odometry that the map rests on, metres.
double map_error(const Recording& recording) {
  const Mapping mapping = map_robots({recording}, {}).value();
  return ate(mapping.robots.front().map->odometry, recording.truth)->max_m;
}

TEST(WheelsAndScans, NoFaultSpoilsTheMap) {
  const double sound = map_error(hall_drive({}));
  Recording none = hall_drive({});
  none.wheel.clear();
  const double without = map_error(none);
  EXPECT_LT(sound, 0.2);
  EXPECT_LT(without, 0.5);
  WheelConfig wheels;
  wheels.sign = WheelSign::reversed;
  EXPECT_EQ(map_error(hall_drive(wheels)), without);
  wheels = {};
  wheels.scale = 1.1;
  EXPECT_LT(map_error(hall_drive(wheels)), sound + 0.1);
  wheels = {};
  wheels.time_offset = 0.1;
  EXPECT_LT(map_error(hall_drive(wheels)), sound + 0.1);
}

TEST(WheelsAndScans, TheAnswerDoesNotDependOnTheNumberOfThreads) {
  WheelConfig wheels;
  wheels.time_offset = 0.1;
  const Recording drive = hall_drive(wheels);
  const int before = num_threads();
  std::vector<Trajectory> moved;
  for (const int threads : {1, 3}) {
    set_num_threads(threads);
    Recording recording = drive;
    only_finding(recording);
    moved.push_back(recording.wheel);
  }
  set_num_threads(before);
  ASSERT_EQ(moved[0].size(), moved[1].size());
  EXPECT_EQ(moved[0].front().stamp, moved[1].front().stamp);
}

/// Nothing is said of what scans do not tell.
TEST(WheelsAndScans, WhereScansAreOpenNothingIsSaid) {
  // A tube without ends in sight: neither the way along it nor turns.
  World world;
  world.name = "tube";
  world.mesh = test::room({-400, -3, 0}, {400, 3, 4});
  Route route{"robot_0", 1.5, {}};
  for (int i = 0; i <= 45; ++i) route.waypoints.emplace_back(i, 0.0, 0.0);
  world.routes = {route};
  ScenarioConfig config;
  config.lidar = lidar_preset("os2-32").value();
  config.imu.on = false;
  config.wheels.scale = 1.1;
  Recording tube = simulate(world, config).value().front();
  EXPECT_TRUE(use_sound_sensors(tube).empty());
  // Without times of its points a sweep may lie before or behind its stamp.
  WheelConfig late;
  late.time_offset = 0.05;
  Recording timeless = hall_drive(late);
  timeless.read_scan = [read = timeless.read_scan](std::size_t i) {
    return read(i).map([](Scan scan) {
      scan.cloud.time_offsets_ns.clear();
      return scan;
    });
  };
  for (const SensorFinding& finding : use_sound_sensors(timeless)) ADD_FAILURE() << finding.sentence;
  // Scans that cannot be read.
  WheelConfig swapped;
  swapped.sign = WheelSign::swapped;
  Recording unreadable = hall_drive(swapped);
  unreadable.read_scan = [](std::size_t) { return Result<Scan>(fail("damaged")); };
  EXPECT_TRUE(use_sound_sensors(unreadable).empty());
  EXPECT_FALSE(unreadable.wheel.empty());
}

TEST(WheelsAndScans, CovariancesThatCannotBeAreNamedAndNotUsed) {
  Recording drive = hall_drive({});
  drive.read_scan = [](std::size_t) { return Result<Scan>(fail("no scan is needed")); };
  WheelCovariance covariance;
  covariance.pose = covariance.twist = Matrix6::Identity() * 0.01;
  Recording sound = hall_drive(drive, covariance);
  EXPECT_TRUE(use_sound_sensors(sound).empty());
  covariance.pose(5, 5) = std::numeric_limits<double>::quiet_NaN();
  expect_finding(hall_drive(drive, covariance), Finding::wheels_bad_covariance, Consequence::noted,
                 "covariance of their pose is not finite; adit does not use it");
  covariance.pose.setZero();
  covariance.twist(0, 0) = 1e9;
  expect_finding(hall_drive(drive, covariance), Finding::wheels_bad_covariance, Consequence::noted,
                 "covariance of their twist is huge (standard deviation 3.16e+04 m/s)");
  covariance.pose(0, 0) = -1.0;
  expect_finding(hall_drive(drive, covariance), Finding::wheels_bad_covariance, Consequence::noted,
                 "pose is not positive definite, and the covariance of their twist is huge");
}

}  // namespace
}  // namespace adit

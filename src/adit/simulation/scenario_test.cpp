// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/scenario.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "adit/core/parallel.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

const Vector3 kHallLow(-2.0, -5.0, 0.0);
const Vector3 kHallHigh(30.0, 5.0, 4.0);

World hall() {
  World world;
  world.name = "hall";
  world.mesh = test::room(kHallLow, kHallHigh);
  world.routes = {{"robot_0", 1.8, {{0, -2, 0}, {20, -2, 0}}},
                  {"robot_1", 1.9, {{25, 2, 0}, {10, 3, 0}, {2, 2, 0}}}};
  return world;
}

ScenarioConfig quick() {
  ScenarioConfig c;
  c.lidar.beams = 8;
  c.lidar.columns = 128;
  return c;
}

std::vector<Recording> simulated(const World& world, const ScenarioConfig& config) {
  return simulate(world, config).value();
}

TEST(Scenario, makes_one_recording_per_route) {
  const std::vector<Recording> recordings = simulated(hall(), quick());
  ASSERT_EQ(recordings.size(), 2U);
  for (std::size_t robot = 0; robot < 2; ++robot) {
    const Recording& r = recordings[robot];
    EXPECT_EQ(r.name, hall().routes[robot].name);
    EXPECT_EQ(r.lidar, "os2-128");
    EXPECT_DOUBLE_EQ(r.T_base_lidar.translation().z(), 0.9);
    EXPECT_GT(r.num_scans(), 80U);
    EXPECT_TRUE(std::ranges::is_sorted(r.scan_stamps));
    const Scan scan = r.read_scan(r.num_scans() - 1).value();
    EXPECT_EQ(scan.stamp, r.scan_stamps.back());
    EXPECT_GT(scan.cloud.size(), 500U);
  }
}

TEST(Scenario, wheels_and_truth_cover_every_sweep) {
  for (const double rate_hz : {10.0, 7.0, 20.0}) {
    ScenarioConfig config = quick();
    config.lidar.rate_hz = rate_hz;
    for (const Recording& r : simulated(hall(), config)) {
      const Duration sweep = sweep_time(config.lidar);
      EXPECT_GT(r.scan_stamps.front() - sweep, r.wheel.front().stamp);
      EXPECT_GE(r.wheel.back().stamp, r.scan_stamps.back());
      for (std::size_t i = 1; i < r.truth.size(); ++i) ASSERT_GT(r.truth[i].stamp, r.truth[i - 1].stamp);
      for (const Stamp stamp : r.scan_stamps) {
        EXPECT_TRUE(std::ranges::binary_search(r.truth, stamp, {}, &StampedPose::stamp));
        EXPECT_TRUE(wheel_delta(r.wheel, stamp - sweep, stamp).has_value());
      }
    }
  }
}

TEST(Scenario, wheels_and_imu_whose_clocks_err_cover_every_sweep) {
  ScenarioConfig config = quick();
  set_conditions(Conditions::field, config);
  config.lidar_errors.clock_s = 0.02;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    config.seed = seed;
    for (const Recording& r : simulated(hall(), config)) {
      const Stamp first_begin = r.scan_stamps.front() - sweep_time(config.lidar);
      EXPECT_GE(r.wheel.front().stamp, Stamp{}) << seed;
      EXPECT_LE(r.wheel.front().stamp, first_begin) << seed;
      EXPECT_GE(r.imu.front().stamp, Stamp{}) << seed;
      EXPECT_LE(r.imu.front().stamp, first_begin) << seed;
      EXPECT_GE(r.wheel.back().stamp, r.scan_stamps.back()) << seed;
      EXPECT_GE(r.imu.back().stamp, r.scan_stamps.back()) << seed;
      EXPECT_GT(r.num_scans(), 80U);
    }
  }
}

TEST(Scenario, a_scan_deskewed_with_the_truth_lies_on_the_walls) {
  ScenarioConfig config = quick();
  config.lidar.noise_near = config.lidar.noise_far = 0.0;
  const Recording r = simulated(hall(), config)[1];
  for (const std::size_t i : {std::size_t{0}, std::size_t{40}, r.num_scans() - 1}) {
    const Scan scan = r.read_scan(i).value();
    for (std::size_t k = 0; k < scan.cloud.size(); ++k) {
      const Stamp stamp = scan.stamp + Duration(scan.cloud.time_offsets_ns[k]);
      const Vector3 p =
          pose_at(r.truth, stamp).value() * (r.T_base_lidar * scan.cloud.points[k].cast<double>());
      const double off =
          std::min((p - kHallLow).cwiseAbs().minCoeff(), (p - kHallHigh).cwiseAbs().minCoeff());
      ASSERT_LT(off, 2e-3);  // the sweep moves on one geodesic, the truth on ten
    }
  }
}

TEST(Scenario, a_walking_robot_sways_and_so_do_its_scans_and_its_imu) {
  ScenarioConfig config = quick();
  config.lidar.noise_near = config.lidar.noise_far = 0.0;
  config.drive.sway_hz = 2.0;
  config.imu = imu_preset("perfect").value();
  const Recording r = simulated(hall(), config)[0];
  const Recording driving = simulated(hall(), quick())[0];
  double highest = 0.0;
  double steepest = 0.0;
  for (const StampedPose& pose : r.truth) {
    highest = std::max(highest, pose.T_world_body.translation().z());
    steepest = std::max(steepest, pose.T_world_body.log().segment<2>(3).norm());
  }
  EXPECT_NEAR(highest, 0.02, 0.003);
  EXPECT_NEAR(steepest, 0.035, 0.006);
  EXPECT_EQ(r.truth.back().T_world_body.translation(), driving.truth.back().T_world_body.translation());
  double roll_rate = 0.0;
  for (const ImuSample& sample : r.imu)
    roll_rate = std::max(roll_rate, std::abs(sample.angular_velocity.x()));
  EXPECT_NEAR(roll_rate, 0.035 * 4.0 * std::numbers::pi, 0.06);
  const Scan scan = r.read_scan(40).value();
  for (std::size_t k = 0; k < scan.cloud.size(); ++k) {
    const Stamp stamp = scan.stamp + Duration(scan.cloud.time_offsets_ns[k]);
    const Vector3 p =
        pose_at(r.truth, stamp).value() * (r.T_base_lidar * scan.cloud.points[k].cast<double>());
    const double off = std::min((p - kHallLow).cwiseAbs().minCoeff(), (p - kHallHigh).cwiseAbs().minCoeff());
    ASSERT_LT(off, 5e-3);
  }
}

TEST(Scenario, scans_are_the_same_in_any_order_on_any_thread) {
  const Recording r = simulated(hall(), quick())[0];
  std::vector<PointCloud> forwards;
  for (std::size_t i = 0; i < 20; ++i) forwards.push_back(r.read_scan(i).value().cloud);
  std::vector<PointCloud> parallel(20);
  parallel_for_each(20, [&](std::size_t i) { parallel[19 - i] = r.read_scan(19 - i).value().cloud; });
  for (std::size_t i = 0; i < 20; ++i) EXPECT_EQ(forwards[i].points, parallel[i].points);
  EXPECT_NE(forwards[3].points, forwards[4].points);  // standing still, yet with new noise
  EXPECT_EQ(simulated(hall(), quick())[0].read_scan(5)->cloud.points, forwards[5].points);
}

TEST(Scenario, the_seed_changes_noise_and_wheels_but_not_the_path) {
  ScenarioConfig other = quick();
  other.seed = 2;
  const Recording a = simulated(hall(), quick())[0];
  const Recording b = simulated(hall(), other)[0];
  EXPECT_NE(a.read_scan(9)->cloud.points, b.read_scan(9)->cloud.points);
  EXPECT_NE(a.wheel.back().T_world_body.translation(), b.wheel.back().T_world_body.translation());
  EXPECT_EQ(a.truth.back().T_world_body.translation(), b.truth.back().T_world_body.translation());
}

TEST(Scenario, each_robot_errs_differently) {
  World world = hall();
  world.routes[1] = world.routes[0];
  world.routes[1].name = "twin";
  const std::vector<Recording> twins = simulated(world, quick());
  EXPECT_NE(twins[0].wheel.back().T_world_body.translation(),
            twins[1].wheel.back().T_world_body.translation());
  EXPECT_NE(twins[0].read_scan(9)->cloud.points, twins[1].read_scan(9)->cloud.points);
}

bool same(const Trajectory& a, const Trajectory& b) {
  return std::ranges::equal(a, b, [](const StampedPose& x, const StampedPose& y) {
    return x.stamp == y.stamp && (x.T_world_body.matrix() - y.T_world_body.matrix()).norm() == 0.0;
  });
}

TEST(Scenario, the_imu_covers_every_sweep_and_sits_in_the_lidar) {
  const Recording r = simulated(hall(), quick())[0];
  EXPECT_EQ(r.imu_name, "icm-20948");
  EXPECT_LT((r.T_base_imu.translation() - Vector3(0.006, -0.012, 0.908)).norm(), 1e-12);
  EXPECT_LT(r.imu.front().stamp, r.scan_stamps.front());
  EXPECT_GE(r.imu.back().stamp, r.scan_stamps.back());
  EXPECT_GT(r.imu_covariance.angular_velocity(0, 0), 0.0);
  for (std::size_t i = 1; i < r.imu.size(); ++i) ASSERT_GT(r.imu[i].stamp, r.imu[i - 1].stamp);
}

TEST(Scenario, a_sensor_less_changes_no_other) {
  const Recording all = simulated(hall(), quick())[1];
  ScenarioConfig config = quick();
  config.imu.on = false;
  const Recording no_imu = simulated(hall(), config)[1];
  EXPECT_TRUE(no_imu.imu.empty());
  EXPECT_TRUE(same(no_imu.wheel, all.wheel));
  EXPECT_EQ(no_imu.read_scan(7)->cloud.points, all.read_scan(7)->cloud.points);
  config = quick();
  config.wheels.on = false;
  const Recording no_wheels = simulated(hall(), config)[1];
  EXPECT_TRUE(no_wheels.wheel.empty());
  ASSERT_EQ(no_wheels.imu.size(), all.imu.size());
  EXPECT_EQ(no_wheels.imu[99].specific_force, all.imu[99].specific_force);
  EXPECT_EQ(no_wheels.read_scan(7)->cloud.points, all.read_scan(7)->cloud.points);
  EXPECT_TRUE(same(no_wheels.truth, all.truth));
}

TEST(Scenario, faults_are_kept_for_evaluation) {
  ScenarioConfig config = quick();
  config.wheels.faults = "slip 3:4 0.5";
  config.imu.faults = "silent 2:2.5";
  const Recording r = simulated(hall(), config)[0];
  ASSERT_EQ(r.faults.size(), 2U);
  EXPECT_EQ(r.faults[0].sensor, "imu");
  EXPECT_EQ(r.faults[1].sensor, "wheels");
  EXPECT_TRUE(simulated(hall(), quick())[0].faults.empty());
}

TEST(Scenario, a_recording_outlives_the_world_it_came_from) {
  Recording kept;
  {
    const World world = hall();
    kept = simulated(world, quick())[0];
  }
  EXPECT_TRUE(kept.read_scan(0).has_value());
  EXPECT_FALSE(kept.read_scan(kept.num_scans()).has_value());
}

std::string error_of(const World& world, const ScenarioConfig& config) {
  const auto recordings = simulate(world, config);
  return recordings ? "" : recordings.error().message;
}

TEST(Scenario, refuses_worlds_and_routes_that_cannot_be_driven) {
  World no_mesh = hall();
  no_mesh.mesh = {};
  EXPECT_NE(error_of(no_mesh, quick()).find("hall"), std::string::npos);
  World no_routes = hall();
  no_routes.routes.clear();
  EXPECT_NE(error_of(no_routes, quick()).find("no routes"), std::string::npos);
  World same_names = hall();
  same_names.routes[1].name = "robot_0";
  EXPECT_NE(error_of(same_names, quick()).find("'robot_0'"), std::string::npos);
  World outside = hall();
  outside.routes[1].waypoints[1].x() = 50.0;
  EXPECT_NE(error_of(outside, quick()).find("robot_1: waypoint 1"), std::string::npos);
}

TEST(Scenario, refuses_configurations_out_of_range) {
  ScenarioConfig config = quick();
  config.lidar.columns = 0;
  EXPECT_NE(error_of(hall(), config).find("lidar.columns"), std::string::npos);
  config = quick();
  config.wheels.effective_track = -1.0;
  EXPECT_NE(error_of(hall(), config).find("wheels.effective_track"), std::string::npos);
  config = quick();
  config.imu.faults = "spin 1:2";
  EXPECT_NE(error_of(hall(), config).find("imu"), std::string::npos);
  config = quick();
  config.wheels.faults = "slip";
  EXPECT_NE(error_of(hall(), config).find("wheels"), std::string::npos);
  config = quick();
  config.lidar.range_max = 0.3;
  EXPECT_NE(error_of(hall(), config).find("range"), std::string::npos);
}

TEST(Scenario, field_conditions_turn_on_every_kind_of_trouble_and_ideal_ones_none) {
  ScenarioConfig config;
  set_conditions(Conditions::field, config);
  EXPECT_TRUE(check_fields(fields_of(config)).has_value());
  for (const double amplitude : {config.lidar_errors.range_bias,
                                 config.lidar_errors.intensity_walk,
                                 config.surfaces.contrast,
                                 config.surfaces.signs,
                                 config.surfaces.wet,
                                 config.air.fog,
                                 config.air.clouds_per_km,
                                 config.air.drips,
                                 config.spread,
                                 config.visits.doors,
                                 config.visits.blocked_ends,
                                 config.visits.walls_per_km,
                                 config.visits.pipes,
                                 config.visits.vehicles_per_km,
                                 config.visits.dust,
                                 config.traffic.vehicles_per_hour,
                                 config.drive.sway_hz,
                                 config.drive.bump_height,
                                 config.drive.manoeuvres.stops_per_km,
                                 config.drive.manoeuvres.reversals_per_km,
                                 config.drive.manoeuvres.turns_per_km,
                                 config.wheels.burst_rate,
                                 config.imu.vibration,
                                 config.imu.vibration_deg})
    EXPECT_GT(amplitude, 0.0);
  EXPECT_TRUE(config.traffic.robots);
  set_conditions(Conditions::ideal, config);
  EXPECT_EQ(config.wheels.burst_rate, 0.0);
  EXPECT_EQ(config.imu.vibration, 0.0);
  EXPECT_EQ(config.imu.vibration_deg, 0.0);
  EXPECT_EQ(config.drive.manoeuvres.turns_per_km, 0.0);
  EXPECT_EQ(config.surfaces.contrast, 0.0);
  EXPECT_FALSE(config.traffic.robots);
  EXPECT_EQ(config.spread, 0.0);
}

TEST(Scenario, field_conditions_are_the_same_on_any_number_of_threads) {
  ScenarioConfig config = quick();
  set_conditions(Conditions::field, config);
  const int threads_before = num_threads();
  std::vector<PointCloud> clouds;
  for (const int threads : {1, 4}) {
    set_num_threads(threads);
    clouds.push_back(simulated(hall(), config)[1].read_scan(40).value().cloud);
  }
  set_num_threads(threads_before);
  EXPECT_EQ(clouds[0].points, clouds[1].points);
  EXPECT_EQ(clouds[0].intensities, clouds[1].intensities);
  EXPECT_FALSE(clouds[0].intensities.empty());
  clouds[0].check();
}

TEST(Scenario, robots_see_one_another_where_told) {
  ScenarioConfig config = quick();
  config.lidar.noise_near = config.lidar.noise_far = 0.0;
  const auto away_from_walls = [&](const Recording& r) {
    std::size_t num = 0;
    for (std::size_t scan = 0; scan < r.num_scans(); scan += 10) {
      const Scan seen = r.read_scan(scan).value();
      const Pose T_world_lidar = pose_at(r.truth, seen.stamp).value() * r.T_base_lidar;
      for (const Eigen::Vector3f& point : seen.cloud.points) {
        const Vector3 p = T_world_lidar * point.cast<double>();
        num += std::min((p - kHallLow).cwiseAbs().minCoeff(), (p - kHallHigh).cwiseAbs().minCoeff()) > 0.4 &&
                       p.z() < 1.2
                   ? 1U
                   : 0U;
      }
    }
    return num;
  };
  EXPECT_EQ(away_from_walls(simulated(hall(), config)[0]), 0U);
  config.traffic.robots = true;
  EXPECT_GT(away_from_walls(simulated(hall(), config)[0]), 10U);
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/scenario.hpp"

#include <algorithm>
#include <set>

#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/progress.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

// All that casting the scans of one robot needs. Copies of its recording share it.
struct Robot {
  std::string name;
  Raycaster raycaster;
  LidarConfig lidar;
  std::uint64_t seed = 0;
  Trajectory truth;
  std::vector<Stamp> scan_stamps;
  bool sways = false;  ///< So that a sweep is not steady.

  /// Of the LiDAR within the sweep that ends then.
  [[nodiscard]] std::vector<Pose> poses_between(Stamp end) const {
    constexpr int kPieces = 20;  // 5 ms each at 10 Hz, as the true poses lie twice as far apart
    std::vector<Pose> poses;
    const Duration sweep = sweep_time(lidar);
    for (int k = 1; sways && k < kPieces; ++k)
      poses.push_back(*pose_at(truth, end - sweep + sweep * k / kPieces) * T_base_lidar(lidar));
    return poses;
  }

  [[nodiscard]] Result<Scan> scan(std::size_t i) const {
    if (i >= scan_stamps.size()) {
      return fail(format("{}: there is no scan {}; the recording has {}", name, i, scan_stamps.size()));
    }
    const Stamp end = scan_stamps[i];
    const Pose T_base_sensor = T_base_lidar(lidar);
    const Result<Pose> T_world_start = pose_at(truth, end - sweep_time(lidar));
    const Result<Pose> T_world_end = pose_at(truth, end);
    if (!T_world_start) return fail(name, T_world_start.error());
    if (!T_world_end) return fail(name, T_world_end.error());
    return cast_scan(raycaster, lidar,
                     {*T_world_start * T_base_sensor, *T_world_end * T_base_sensor, end, mix64(seed, i),
                      poses_between(end)});
  }
};

// Stamps from the end of the second turn on, so that the first sweep begins well after the first wheel
// odometry.
std::vector<Stamp> scan_stamps(const Trajectory& truth, const LidarConfig& lidar) {
  std::vector<Stamp> stamps;
  for (std::int64_t i = 2;; ++i) {
    const Stamp stamp = truth.front().stamp + from_seconds(static_cast<double>(i) / lidar.rate_hz);
    if (stamp > truth.back().stamp) return stamps;
    stamps.push_back(stamp);
  }
}

Trajectory with_poses_at(const Trajectory& truth, const std::vector<Stamp>& stamps) {
  Trajectory out = truth;
  for (const Stamp stamp : stamps) {
    const auto known = std::ranges::lower_bound(truth, stamp, {}, &StampedPose::stamp);
    if (known != truth.end() && known->stamp == stamp) continue;
    out.push_back({stamp, *pose_at(truth, stamp)});
  }
  std::ranges::sort(out, {}, &StampedPose::stamp);
  return out;
}

Result<> check(const World& world, ScenarioConfig config) {
  if (Result<> fields = check_fields(fields_of(config)); !fields) return fields;
  if (Result<> lidar = check_lidar(config.lidar); !lidar) return lidar;
  if (Result<> wheels = check_wheels(config.wheels); !wheels) return wheels;
  if (Result<> imu = check_imu(config.imu); !imu) return imu;
  if (world.routes.empty()) return fail(world.name + ": the world has no routes, so no robot can drive");
  std::set<std::string> names;
  for (const Route& route : world.routes) {
    if (!names.insert(route.name).second)
      return fail("two routes are called '" + route.name + "'; names must differ");
  }
  return {};
}

constexpr std::uint64_t kImuStream = 0x696d75;  // numbers of their own for the IMU's errors

void add_wheels(Recording& recording, const Robot& robot, const WheelConfig& wheels) {
  if (!wheels.on) return;
  const std::uint64_t seed = mix64(robot.seed);
  recording.wheel = wheel_odometry(robot.truth, wheels, seed);
  recording.faults = wheel_faults(robot.truth, wheels, seed);
}

void add_imu(Recording& recording, const Robot& robot, const ImuConfig& imu) {
  if (!imu.on) return;
  recording.T_base_imu = recording.T_base_lidar * T_lidar_imu(imu);
  recording.imu_mount_source = "simulation";
  recording.imu_name = imu.name;
  recording.imu_covariance = covariance_of(imu);
  recording.imu = imu_samples(robot.truth, recording.T_base_imu, imu, mix64(robot.seed, kImuStream));
  std::ranges::copy(imu_faults(imu, robot.truth.front().stamp), std::back_inserter(recording.faults));
  std::ranges::stable_sort(recording.faults, {}, &SensorFault::begin);
}

Recording recording_of(Robot robot, const ScenarioConfig& config) {
  Recording recording;
  recording.name = robot.name;
  recording.lidar = robot.lidar.name;
  recording.T_base_lidar = T_base_lidar(robot.lidar);
  recording.mount_source = "simulation";
  add_wheels(recording, robot, config.wheels);
  add_imu(recording, robot, config.imu);
  robot.scan_stamps = scan_stamps(robot.truth, robot.lidar);
  robot.truth = with_poses_at(robot.truth, robot.scan_stamps);
  recording.scan_stamps = robot.scan_stamps;
  recording.truth = robot.truth;
  const auto shared = std::make_shared<const Robot>(std::move(robot));
  recording.read_scan = [shared](std::size_t i) { return shared->scan(i); };
  return recording;
}

// Uses a watertight raycaster, so that no wheel falls between two triangles. Scans use the fast one:
// watertight edges would move one point in some 1e5, and with it the bytes of every recording.
Result<std::vector<Trajectory>> drive_all(const World& world, const DriveConfig& config) {
  const Phase phase("driving the routes", world.routes.size() + 1);
  const Result<Raycaster> floor = Raycaster::build(world.mesh, EdgeRule::watertight);
  if (!floor) return fail(world.name, floor.error());
  phase.advance();
  std::vector<Result<Trajectory>> driven(world.routes.size());
  parallel_for_each(world.routes.size(), [&](std::size_t i) {
    driven[i] = drive(*floor, world.routes[i], config, Stamp{});
    phase.advance();
  });
  std::vector<Trajectory> truths;
  for (Result<Trajectory>& truth : driven) {
    if (!truth) return tl::unexpected(truth.error());
    truths.push_back(std::move(*truth));
  }
  return truths;
}

}  // namespace

Result<std::vector<Recording>> simulate(const World& world, const ScenarioConfig& config) {
  if (const Result<> checked = check(world, config); !checked) return tl::unexpected(checked.error());
  const Result<std::vector<Trajectory>> truths = drive_all(world, config.drive);
  if (!truths) return tl::unexpected(truths.error());
  const Result<Raycaster> raycaster = Raycaster::build(world.mesh);
  if (!raycaster) return fail(world.name, raycaster.error());
  std::vector<Recording> recordings;
  for (std::size_t i = 0; i < world.routes.size(); ++i) {
    recordings.push_back(recording_of({world.routes[i].name,
                                       *raycaster,
                                       config.lidar,
                                       mix64(config.seed, i),
                                       (*truths)[i],
                                       {},
                                       config.drive.sway_hz > 0.0},
                                      config));
  }
  return recordings;
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/scenario.hpp"

#include <algorithm>
#include <set>

#include "adit/core/format.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

// All that casting the scans of one robot needs; shared by the copies of its recording.
struct Robot {
  std::string name;
  Raycaster raycaster;
  LidarConfig lidar;
  std::uint64_t seed = 0;
  Trajectory truth;
  std::vector<Stamp> scan_stamps;

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
                     {*T_world_start * T_base_sensor, *T_world_end * T_base_sensor, end, mix64(seed, i)});
  }
};

// From the end of the second turn on, so that the first sweep begins well after the wheels' first word.
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
  if (world.routes.empty()) return fail(world.name + ": the world has no routes, so no robot can drive");
  std::set<std::string> names;
  for (const Route& route : world.routes) {
    if (!names.insert(route.name).second)
      return fail("two routes are called '" + route.name + "'; names must differ");
  }
  return {};
}

Recording recording_of(Robot robot, const WheelConfig& wheels) {
  Recording recording;
  recording.name = robot.name;
  recording.lidar = robot.lidar.name;
  recording.T_base_lidar = T_base_lidar(robot.lidar);
  recording.wheel = wheel_odometry(robot.truth, wheels, mix64(robot.seed));
  robot.scan_stamps = scan_stamps(robot.truth, robot.lidar);
  robot.truth = with_poses_at(robot.truth, robot.scan_stamps);
  recording.scan_stamps = robot.scan_stamps;
  recording.truth = robot.truth;
  const auto shared = std::make_shared<const Robot>(std::move(robot));
  recording.read_scan = [shared](std::size_t i) { return shared->scan(i); };
  return recording;
}

}  // namespace

Result<std::vector<Recording>> simulate(const World& world, const ScenarioConfig& config) {
  if (const Result<> checked = check(world, config); !checked) return tl::unexpected(checked.error());
  const Result<Raycaster> raycaster = Raycaster::build(world.mesh);
  if (!raycaster) return fail(world.name, raycaster.error());
  std::vector<Recording> recordings;
  for (const Route& route : world.routes) {
    const std::uint64_t seed = mix64(config.seed, recordings.size());
    const Result<Trajectory> truth = drive(*raycaster, route, config.drive, Stamp{});
    if (!truth) return tl::unexpected(truth.error());
    recordings.push_back(
        recording_of({route.name, *raycaster, config.lidar, seed, *truth, {}}, config.wheels));
  }
  return recordings;
}

}  // namespace adit

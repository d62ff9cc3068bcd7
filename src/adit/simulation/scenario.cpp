// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/scenario.hpp"

#include <algorithm>
#include <set>
#include <sstream>

#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/progress.hpp"
#include "adit/core/rng.hpp"
#include "adit/simulation/changed_walls.hpp"

namespace adit {
namespace {

constexpr std::uint64_t kDustStream = 0x64757374;

// What drives and drifts around all robots.
struct Surroundings {
  bool robots_see_robots = false;
  std::uint64_t seed = 0;
  Surfaces surfaces;
  std::vector<Trajectory> truths;
  std::vector<DrivingVehicle> vehicles;
  std::vector<DrawnVisit> visits;              // by robot
  std::vector<std::vector<DustCloud>> clouds;  // by robot
};

// All that casting the scans of one robot needs. Copies of its recording share it.
struct Robot {
  std::string name;
  std::size_t number = 0;
  std::shared_ptr<const Surroundings> around;
  Raycaster raycaster;
  LidarConfig lidar;
  LidarUnit unit;
  std::uint64_t seed = 0;
  Trajectory truth;
  std::vector<Stamp> sweep_ends;
  std::vector<Stamp> scan_stamps;  ///< As reported.
  bool sways = false;              ///< So that a sweep is not steady.

  [[nodiscard]] Pose T_base_sensor() const { return T_base_lidar(lidar) * unit.T_nominal_true; }

  /// Of the LiDAR within the sweep that ends then.
  [[nodiscard]] std::vector<Pose> poses_between(Stamp end) const {
    constexpr int kPieces = 20;  // 5 ms each at 10 Hz, as the true poses lie twice as far apart
    std::vector<Pose> poses;
    const Duration sweep = sweep_time(lidar);
    for (int k = 1; sways && k < kPieces; ++k)
      poses.push_back(*pose_at(truth, end - sweep + sweep * k / kPieces) * T_base_sensor());
    return poses;
  }

  [[nodiscard]] TriangleMesh movers(Stamp stamp) const {
    TriangleMesh mesh = people_around(truth, stamp, around->visits[number].people);
    if (around->robots_see_robots)
      append(mesh, robots_around(number, stamp, lidar.range_max, around->truths));
    append(mesh, vehicles_around(number, stamp, around->truths, around->vehicles));
    return mesh;
  }

  [[nodiscard]] Result<Scan> scan(std::size_t i) const {
    if (i >= scan_stamps.size()) {
      return fail(format("{}: there is no scan {}; the recording has {}", name, i, scan_stamps.size()));
    }
    const Stamp end = sweep_ends[i];
    const Result<Pose> T_world_start = pose_at(truth, end - sweep_time(lidar));
    const Result<Pose> T_world_end = pose_at(truth, end);
    if (!T_world_start) return fail(name, T_world_start.error());
    if (!T_world_end) return fail(name, T_world_end.error());
    Sweep sweep{*T_world_start * T_base_sensor(),
                *T_world_end * T_base_sensor(),
                end,
                mix64(seed, i),
                poses_between(end),
                around->visits[number].dust};
    constexpr int kParts = 5;  // of 20 ms at 10 Hz: a vehicle and a robot near one another by less than 10 cm
    for (int part = 0; part < kParts; ++part) {
      const Stamp middle = end - sweep_time(lidar) + sweep_time(lidar) * (2 * part + 1) / (2 * kParts);
      const TriangleMesh moving = movers(middle);
      std::optional<Raycaster>& there = sweep.movers.emplace_back();
      if (moving.empty()) continue;
      Result<Raycaster> caster = Raycaster::build(moving);
      if (!caster) return fail(name, caster.error());
      there = *std::move(caster);
    }
    sweep.surfaces = around->surfaces.on_visit(mix64(seed, kDustStream));
    sweep.air = air_at(end, sweep.T_world_lidar_end.translation(), around->visits[number].air,
                       around->clouds[number], around->seed);
    Scan scan = cast_scan(raycaster, lidar, sweep, unit);
    scan.stamp = scan_stamps[i];
    return scan;
  }
};

// From the end of the second turn on, so that the first sweep begins well after the first wheel odometry.
std::vector<Stamp> sweep_ends(const Trajectory& truth, const LidarConfig& lidar, Stamp last) {
  std::vector<Stamp> stamps;
  for (std::int64_t i = 2;; ++i) {
    const Stamp stamp = truth.front().stamp + from_seconds(static_cast<double>(i) / lidar.rate_hz);
    if (stamp > last) return stamps;
    stamps.push_back(stamp);
  }
}

// Wheels and IMU whose clocks are early fall silent before the drive ends, and a sweep needs both.
Stamp last_heard_of_all(const Robot& robot) {
  return robot.truth.back().stamp + std::min({Duration(0), robot.unit.wheels_late, robot.unit.imu_late});
}

// As reported: in order, and within the time that the truth covers.
std::vector<Stamp> with_jitter(std::vector<Stamp> stamps, Duration apart, Stamp last, double sigma_s,
                               std::uint64_t seed) {
  constexpr double kMostJitter = 2.0;             // sigmas
  const double most_s = 0.4 * to_seconds(apart);  // nearly half: then they stay in order
  if (sigma_s == 0.0) return stamps;
  Rng rng(seed);
  for (Stamp& stamp : stamps) {
    const double off = sigma_s * std::clamp(rng.normal(), -kMostJitter, kMostJitter);
    stamp = std::min(stamp + from_seconds(std::clamp(off, -most_s, most_s)), last);
  }
  return stamps;
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
  if (const auto lidars = lidars_of(config); !lidars) return fail("lidars", lidars.error());
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

// Numbers of their own for the errors of each.
constexpr std::uint64_t kImuStream = 0x696d75;
constexpr std::uint64_t kUnitStream = 0x756e6974;
constexpr std::uint64_t kJitterStream = 0x6a69747465;
constexpr std::uint64_t kVisitStream = 0x7669736974;
constexpr std::uint64_t kSurroundingsStream = 0x776f726c64;
constexpr std::uint64_t kDriveStream = 0x6472697665;
constexpr std::uint64_t kWallStream = 0x77616c6c;
constexpr std::uint64_t kAirStream = 0x616972;
constexpr std::uint64_t kSpreadStream = 0x737072656164;

void add_wheels(Recording& recording, const Robot& robot, WheelConfig wheels) {
  if (!wheels.on) return;
  wheels.time_offset += to_seconds(robot.unit.wheels_late);
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
  const Pose T_base_imu = robot.T_base_sensor() * T_lidar_imu(imu);
  recording.imu = imu_samples(robot.truth, T_base_imu, imu, mix64(robot.seed, kImuStream));
  for (ImuSample& sample : recording.imu) sample.stamp = sample.stamp + robot.unit.imu_late;
  std::ranges::copy(imu_faults(imu, robot.truth.front().stamp), std::back_inserter(recording.faults));
  std::ranges::stable_sort(recording.faults, {}, &SensorFault::begin);
}

/// A recording begins at 0: earlier stamps, of clocks that are early, no file of ROS holds.
void drop_before(Recording& recording, Stamp begin) {
  std::erase_if(recording.wheel, [&](const StampedPose& pose) { return pose.stamp < begin; });
  std::erase_if(recording.imu, [&](const ImuSample& sample) { return sample.stamp < begin; });
}

Recording recording_of(Robot robot, const ScenarioConfig& config) {
  Recording recording;
  recording.name = robot.name;
  recording.lidar = robot.lidar.name;
  recording.T_base_lidar = T_base_lidar(robot.lidar);
  recording.mount_source = "simulation";
  add_wheels(recording, robot, config.wheels);
  add_imu(recording, robot, config.imu);
  drop_before(recording, robot.truth.front().stamp);
  const Stamp last = last_heard_of_all(robot);
  robot.sweep_ends = sweep_ends(robot.truth, robot.lidar, last);
  robot.scan_stamps = with_jitter(robot.sweep_ends, sweep_time(robot.lidar), last, robot.unit.jitter_s,
                                  mix64(robot.seed, kJitterStream));
  robot.truth = with_poses_at(robot.truth, robot.scan_stamps);
  recording.scan_stamps = robot.scan_stamps;
  recording.truth = robot.truth;
  const auto shared = std::make_shared<const Robot>(std::move(robot));
  recording.read_scan = [shared](std::size_t i) { return shared->scan(i); };
  return recording;
}

struct Drives {
  Raycaster floor;
  std::vector<Trajectory> truths;
};

// Uses a watertight raycaster, so that no wheel falls between two triangles. Scans use the fast one:
// watertight edges would move one point in some 1e5, and with it the bytes of every recording.
Result<Drives> drive_all(const World& world, const DriveConfig& config, std::uint64_t seed) {
  const Phase phase("driving the routes", world.routes.size() + 1);
  const Result<Raycaster> floor = Raycaster::build(world.mesh, EdgeRule::watertight);
  if (!floor) return fail(world.name, floor.error());
  phase.advance();
  std::vector<Result<Trajectory>> driven(world.routes.size());
  parallel_for_each(world.routes.size(), [&](std::size_t i) {
    driven[i] = drive(*floor, world.routes[i], config, Stamp{}, mix64(mix64(seed, i), kDriveStream));
    phase.advance();
  });
  Drives drives{*floor, {}};
  for (Result<Trajectory>& truth : driven) {
    if (!truth) return tl::unexpected(truth.error());
    drives.truths.push_back(std::move(*truth));
  }
  return drives;
}

// What each robot's LiDAR sees: the world, and what stands in it during that robot's visit.
Result<std::vector<Raycaster>> raycasters_of(const World& world, const Drives& drives,
                                             const ScenarioConfig& config) {
  const Result<Raycaster> empty = Raycaster::build(world.mesh);
  if (!empty) return fail(world.name, empty.error());
  const VisitConfig site = drawn_site(config.visits, config.spread, mix64(config.seed, kSpreadStream));
  const std::vector<TriangleMesh> things =
      parked_things(drives.floor, drives.truths, site, mix64(config.seed, kVisitStream));
  std::vector<Raycaster> raycasters;
  for (std::size_t robot = 0; robot < things.size(); ++robot) {
    Result<Raycaster> met = *empty;
    if (!things[robot].empty() || site.walls_per_km > 0.0) {
      TriangleMesh mesh =
          with_changed_walls(world.mesh, drives.truths[robot], {site.walls_per_km, site.wall_change},
                             mix64(mix64(config.seed, kWallStream), robot));
      append(mesh, things[robot]);
      met = Raycaster::build(mesh);
      if (!met) return fail(world.name, met.error());
    }
    raycasters.push_back(*std::move(met));
  }
  return raycasters;
}

std::shared_ptr<const Surroundings> surroundings_of(const Drives& drives, const ScenarioConfig& config) {
  const std::uint64_t seed = mix64(config.seed, kSurroundingsStream);
  Surroundings around{config.traffic.robots,
                      seed,
                      Surfaces(config.surfaces, seed),
                      drives.truths,
                      draw_vehicles(drives.floor, drives.truths, config.traffic, seed),
                      {},
                      {}};
  for (std::size_t robot = 0; robot < drives.truths.size(); ++robot) {
    const std::uint64_t of_robot = mix64(mix64(config.seed, kAirStream), robot);
    around.visits.push_back(
        drawn_visit(config.visits, config.air, config.spread, mix64(of_robot, kSpreadStream)));
    around.clouds.push_back(draw_clouds(drives.truths[robot], around.visits.back().air, of_robot));
  }
  return std::make_shared<const Surroundings>(std::move(around));
}

}  // namespace

std::string_view to_string(Conditions conditions) {
  return conditions == Conditions::field ? "field" : "ideal";
}

Result<std::vector<LidarConfig>> lidars_of(const ScenarioConfig& config) {
  std::vector<LidarConfig> lidars;
  std::istringstream names(config.lidars);
  for (std::string name; std::getline(names, name, ',');) {
    std::erase(name, ' ');
    Result<LidarConfig> lidar = lidar_preset(name);
    if (!lidar) return tl::unexpected(lidar.error());
    lidar->mount_forward = config.lidar.mount_forward;
    lidar->mount_height = config.lidar.mount_height;
    lidars.push_back(*std::move(lidar));
  }
  if (lidars.empty()) lidars.push_back(config.lidar);
  return lidars;
}

std::string sensors_text(const ScenarioConfig& simulation) {
  if (simulation.lidars.empty()) return simulation.lidar.name;
  std::string text;
  for (const char c : simulation.lidars)
    if (c != ' ') text += c == ',' ? ", " : std::string(1, c);
  return text;
}

void set_conditions(Conditions conditions, ScenarioConfig& config) {
  constexpr double kSpread = 0.7;  // by a factor of 2 either way, at most 4: chosen
  const bool field = conditions == Conditions::field;
  config.spread = field ? kSpread : 0.0;
  config.lidar_errors = field ? field_lidar_errors() : LidarErrorConfig();
  config.surfaces = field ? field_surfaces() : SurfaceConfig();
  config.air = field ? field_air() : AirConfig();
  config.visits = field ? field_visits() : VisitConfig();
  config.traffic = field ? field_traffic() : TrafficConfig();
  config.drive = field ? field_drive(config.drive) : ideal_drive(config.drive);
  if (field) {
    config.wheels = field_wheels(config.wheels);
    config.imu = field_imu(config.imu);
  } else {
    config.wheels.burst_rate = 0.0;
    config.imu.vibration = config.imu.vibration_deg = 0.0;
  }
}

Result<std::vector<Recording>> simulate(const World& world, const ScenarioConfig& config) {
  if (const Result<> checked = check(world, config); !checked) return tl::unexpected(checked.error());
  const Result<Drives> drives = drive_all(world, config.drive, config.seed);
  if (!drives) return tl::unexpected(drives.error());
  const Result<std::vector<Raycaster>> raycasters = raycasters_of(world, *drives, config);
  if (!raycasters) return tl::unexpected(raycasters.error());
  const std::shared_ptr<const Surroundings> around = surroundings_of(*drives, config);
  const std::vector<LidarConfig> lidars = *lidars_of(config);
  std::vector<Recording> recordings;
  for (std::size_t i = 0; i < world.routes.size(); ++i) {
    const LidarConfig& lidar = lidars[i % lidars.size()];
    const std::uint64_t seed = mix64(config.seed, i);
    recordings.push_back(
        recording_of({world.routes[i].name,
                      i,
                      around,
                      (*raycasters)[i],
                      lidar,
                      draw_lidar_unit(config.lidar_errors, num_rings(lidar), i, mix64(seed, kUnitStream)),
                      seed,
                      drives->truths[i],
                      {},
                      {},
                      is_unsteady(config.drive)},
                     config));
  }
  return recordings;
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/fleet_traffic.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "adit/core/rng.hpp"
#include "adit/simulation/things.hpp"

namespace adit {
namespace {

constexpr double kRobotsApart =
    1.5;  ///< Metres between two robots' middles: nearer, one would be in the other.

Pose pose_on(const Trajectory& truth, Stamp stamp) {
  return *pose_at(truth, std::clamp(stamp, truth.front().stamp, truth.back().stamp));
}

/// Where it is, if it is there then.
std::optional<PlacedThing> placed(const DrivingVehicle& vehicle, Stamp stamp, const Trajectory& truth) {
  constexpr double kInSight = 40.0;  // seconds before and after it passes the robot
  const double since = to_seconds(stamp - vehicle.met);
  const Stamp on_path = vehicle.met + from_seconds(vehicle.pace * since);
  if (std::abs(since) > kInSight || on_path < truth.front().stamp || on_path > truth.back().stamp) return {};
  const double turned = vehicle.pace < 0.0 ? std::numbers::pi : 0.0;
  Thing thing = kVehicle;
  thing.width = vehicle.width;
  return PlacedThing{thing, pose_on(truth, on_path) * Pose::translation_of(0.0, vehicle.left, 0.0) *
                                Pose::planar(0.0, 0.0, turned)};
}

}  // namespace

Fields fields_of(TrafficConfig& c) {
  return {{"robots", &c.robots, "", 0, 0, "whether robots see one another"},
          {"vehicles_per_hour", &c.vehicles_per_hour, "1/h", 0, 1000,
           "vehicles that meet or overtake each robot"}};
}

TrafficConfig field_traffic() { return {true, 12.0}; }

std::vector<DrivingVehicle> draw_vehicles(const Raycaster& floor, std::span<const Trajectory> truths,
                                          const TrafficConfig& config, std::uint64_t seed) {
  constexpr double kPace = 2.0;
  std::vector<DrivingVehicle> vehicles;
  for (std::size_t robot = 0; robot < truths.size(); ++robot) {
    Rng rng(mix64(seed, robot));
    const Trajectory& truth = truths[robot];
    const double hours = to_seconds(truth.back().stamp - truth.front().stamp) / 3600.0;
    const std::uint64_t num = rng.poisson(hours * config.vehicles_per_hour);
    for (std::uint64_t i = 0; i < num; ++i) {
      const StampedPose& met = ByLength(truth).at(rng.uniform());
      const double side = rng.uniform() < 0.5 ? 1.0 : -1.0;
      const double pace = rng.uniform() < 0.5 ? kPace : -kPace;
      const std::optional<PlacedThing> there = beside(floor, met.T_world_body, side, kVehicle);
      if (!there) continue;
      constexpr double kSlack = 0.05;  // not at the wall but as near as it passes: walls swerve
      const double left = side * (kPassingRoom + kSlack + there->thing.width / 2.0);
      vehicles.push_back({robot, met.stamp, pace, left, there->thing.width});
    }
  }
  return vehicles;
}

TriangleMesh robot_body(const Pose& T_world_base) {
  TriangleMesh mesh = box(T_world_base, {-0.4, -0.3, 0.1}, {0.4, 0.3, 0.5});
  append(mesh, box(T_world_base, {-0.05, -0.05, 0.5}, {0.05, 0.05, 0.85}));
  append(mesh, box(T_world_base, {-0.06, -0.06, 0.85}, {0.06, 0.06, 0.97}));
  return mesh;
}

TriangleMesh robots_around(std::size_t robot, Stamp stamp, double reach, std::span<const Trajectory> truths) {
  const Pose self = pose_on(truths[robot], stamp);
  TriangleMesh mesh;
  for (std::size_t other = 0; other < truths.size(); ++other) {
    if (other == robot) continue;
    const Pose pose = pose_on(truths[other], stamp);
    const double away = (pose.translation() - self.translation()).norm();
    if (away > kRobotsApart && away < reach) append(mesh, robot_body(pose));
  }
  return mesh;
}

TriangleMesh vehicles_around(std::size_t robot, Stamp stamp, std::span<const Trajectory> truths,
                             std::span<const DrivingVehicle> vehicles) {
  TriangleMesh mesh;
  for (const DrivingVehicle& vehicle : vehicles) {
    const std::optional<PlacedThing> there = placed(vehicle, stamp, truths[vehicle.robot]);
    if (there && leaves_room(*there, pose_on(truths[robot], stamp))) append(mesh, mesh_of(*there));
  }
  return mesh;
}

}  // namespace adit

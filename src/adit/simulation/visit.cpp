// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/visit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "adit/core/rng.hpp"
#include "adit/simulation/doors.hpp"
#include "adit/simulation/things.hpp"
#include "adit/simulation/wall_lines.hpp"

namespace adit {
namespace {

constexpr int kTries = 30;

bool pass_by(std::span<const Trajectory> paths, const Vector3& place) {
  return std::ranges::any_of(paths, [&](const Trajectory& path) {
    return std::ranges::any_of(path, [&](const StampedPose& pose) {
      return (pose.T_world_body.translation() - place).squaredNorm() < kSameTunnel * kSameTunnel;
    });
  });
}

/// Puts `per_km` of them beside `path`, wherever no path of `others` is blocked, but for where paths of
/// `furnished` pass by.
TriangleMesh parked_along(const Raycaster& floor, const Trajectory& path, std::span<const Trajectory> others,
                          std::span<const Trajectory> furnished, const Thing& thing, double per_km,
                          Rng& rng) {
  TriangleMesh mesh;
  const ByLength along(path);
  const std::uint64_t num = rng.poisson(along.length() / 1000.0 * per_km);
  for (std::uint64_t i = 0; i < num; ++i) {
    for (int attempt = 0; attempt < kTries; ++attempt) {
      const double share = rng.uniform();
      const double side = rng.uniform() < 0.5 ? 1.0 : -1.0;
      const Pose T_world_base = along.at(share).T_world_body;
      if (pass_by(furnished, T_world_base.translation())) break;
      const std::optional<PlacedThing> parked = beside(floor, T_world_base, side, thing);
      if (!parked ||
          !std::ranges::all_of(others, [&](const Trajectory& other) { return leaves_room(*parked, other); }))
        continue;
      append(mesh, mesh_of(*parked));
      break;
    }
  }
  return mesh;
}

}  // namespace

Fields fields_of(VisitConfig& c) {
  return {
      {"vehicles_per_km", &c.vehicles_per_km, "1/km", 0, 1000, "vehicles parked along each robot's path"},
      {"pallets_per_km", &c.pallets_per_km, "1/km", 0, 1000, "pallets beside each robot's path"},
      {"changed", &c.changed, "", 0, 1, "share of what a robot meets of them that no other meets"},
      {"people", &c.people, "", 0, 20, "people who walk with each robot"},
      {"dust", &c.dust, "", 0, 0.5, "share of rays that end in dust near the sensor"},
      {"doors", &c.doors, "", 0, 1, "share of openings beside a path that are closed for one robot alone"},
      {"blocked_ends", &c.blocked_ends, "", 0, 1, "share of paths beyond whose end a machine stands"},
      {"walls_per_km", &c.walls_per_km, "1/km", 0, 50,
       "stretches of 20 m whose walls are moved for one robot alone"},
      {"wall_change", &c.wall_change, "m", 0, 1, "by how much at most; drawn from a sixth of it"},
      {"pipes", &c.pipes, "", 0, 1, "share of all paths with pipes and cables along a wall"}};
}

VisitConfig field_visits() { return {4.0, 8.0, 0.5, 1, 0.002, 0.2, 0.5, 2.0, 0.3, 0.5}; }

std::vector<TriangleMesh> parked_things(const Raycaster& floor, std::span<const Trajectory> truths,
                                        const VisitConfig& config, std::uint64_t seed) {
  constexpr std::uint64_t kLasting = 1;
  constexpr std::uint64_t kPassingBy = 2;
  constexpr std::uint64_t kDoors = 3;
  constexpr std::uint64_t kEnds = 4;
  constexpr std::uint64_t kPipes = 5;
  const auto along = [&](std::size_t robot, std::span<const Trajectory> others,
                         std::span<const Trajectory> furnished, double share, std::uint64_t stream) {
    Rng rng(mix64(mix64(seed, stream), robot));
    const auto parked = [&](const Thing& thing, double per_km) {
      return parked_along(floor, truths[robot], others, furnished, thing, share * per_km, rng);
    };
    TriangleMesh mesh = parked(kVehicle, config.vehicles_per_km);
    append(mesh, parked(kPallet, config.pallets_per_km));
    return mesh;
  };
  TriangleMesh lasting;
  // What lasts stands there once, however many paths pass by.
  for (std::size_t robot = 0; robot < truths.size(); ++robot)
    append(lasting, along(robot, truths, truths.first(robot), 1.0 - config.changed, kLasting));
  append(lasting, wall_lines(floor, truths, config.pipes, mix64(seed, kPipes)));
  std::vector<TriangleMesh> met(truths.size(), lasting);
  for (std::size_t robot = 0; robot < truths.size(); ++robot)
    append(met[robot], along(robot, truths.subspan(robot, 1), {}, config.changed, kPassingBy));
  for (std::size_t robot = 0; robot < truths.size(); ++robot) {
    append(met[robot], closed_doors(floor, truths[robot], config.doors, mix64(mix64(seed, kDoors), robot)));
    if (Rng(mix64(mix64(seed, kEnds), robot)).uniform() < config.blocked_ends)
      append(met[robot], blocked_end(floor, truths[robot]));
  }
  return met;
}

TriangleMesh people_around(const Trajectory& truth, Stamp stamp, int num_people) {
  constexpr double kNearest = 1.8;  // seconds ahead of or behind the robot,
  constexpr double kOneAfterTheOther = 0.6;
  constexpr double kBeside = 0.8;  // metres, alternately left and right
  constexpr double kGait = 0.15;   // metres to the side, once per second: nobody walks on rails
  TriangleMesh mesh;
  for (int i = 0; i < num_people; ++i) {
    const int pair = i / 2;
    const double away = kNearest + kOneAfterTheOther * pair;
    const Stamp there = stamp + from_seconds(i % 2 == 0 ? away : -away);
    const Result<Pose> T_world_base =
        pose_at(truth, std::clamp(there, truth.front().stamp, truth.back().stamp));
    const double side = pair % 2 == 0 ? 1.0 : -1.0;
    const double sway = kGait * std::sin(2.0 * std::numbers::pi * stamp.seconds());
    const Pose T_world_person = *T_world_base * Pose::translation_of(0.0, side * kBeside + sway, 0.0);
    append(mesh, box(T_world_person, {-0.1, -0.18, 0.0}, {0.1, 0.18, 0.9}));
    append(mesh, box(T_world_person, {-0.14, -0.25, 0.9}, {0.14, 0.25, 1.5}));
    append(mesh, box(T_world_person, {-0.1, -0.1, 1.5}, {0.1, 0.1, 1.75}));
  }
  return mesh;
}

}  // namespace adit

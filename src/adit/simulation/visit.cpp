// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/visit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "adit/core/rng.hpp"
#include "adit/simulation/floor_line.hpp"

namespace adit {
namespace {

/// What can stand beside a path; metres. Along the wall, across it, above the floor.
struct Thing {
  double length;
  double width;
  double height;
  double ground_clearance;
};
constexpr Thing kVehicle{4.6, 1.9, 2.0, 0.35};
constexpr Thing kPallet{1.2, 0.8, 1.1, 0.1};

constexpr double kPassing = 0.85;  ///< From the middle of a path to a thing: half a robot, and half a metre.
constexpr double kOffTheWall = 0.15;
constexpr double kNarrowest =
    0.5;  ///< Share of its width and length that a thing may have in a narrow drift.
constexpr double kWidestDrift = 15.0;
constexpr int kTries = 30;

/// An upright box around the origin of its frame, its faces looking outwards.
TriangleMesh box(const Pose& T_world_box, const Vector3& low, const Vector3& high) {
  TriangleMesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3 p((corner & 1) != 0 ? high.x() : low.x(), (corner & 2) != 0 ? high.y() : low.y(),
                    (corner & 4) != 0 ? high.z() : low.z());
    mesh.vertices.push_back((T_world_box * p).cast<float>());
  }
  constexpr std::array<std::array<int, 4>, 6> kSides{
      {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};
  for (const auto& [a, b, c, d] : kSides) {
    mesh.triangles.emplace_back(a, b, c);
    mesh.triangles.emplace_back(a, c, d);
  }
  return mesh;
}

struct Parked {
  Thing thing;
  Pose T_world_thing;
};

/// A body on wheels or feet with a cabin at one end.
TriangleMesh mesh_of(const Parked& parked) {
  const auto& [thing, T_world_thing] = parked;
  const double x = thing.length / 2.0;
  const double y = thing.width / 2.0;
  const double deck = thing.ground_clearance + 0.55 * (thing.height - thing.ground_clearance);
  TriangleMesh mesh = box(T_world_thing, {-x, -y, thing.ground_clearance}, {x, y, deck});
  append(mesh, box(T_world_thing, {-x, -y, deck}, {-0.1 * x, y, thing.height}));
  const double wheel = 0.15 * thing.length;
  for (const double end : {-0.6 * x, 0.6 * x})
    for (const double side : {-0.8 * y, 0.8 * y})
      append(mesh, box(T_world_thing, {end - wheel / 2.0, side - 0.2 * y, 0.0},
                       {end + wheel / 2.0, side + 0.2 * y, thing.ground_clearance}));
  return mesh;
}

bool leaves_room(const Parked& parked, const Trajectory& path) {
  constexpr double kSameLevel = 2.0;
  const Thing& thing = parked.thing;
  const Pose T_thing_world = parked.T_world_thing.inverse();
  return std::ranges::none_of(path, [&](const StampedPose& robot) {
    const Vector3 p = T_thing_world * robot.T_world_body.translation();
    const double beside = std::max(std::abs(p.x()) - thing.length / 2.0, std::abs(p.y()) - thing.width / 2.0);
    return beside < kPassing && std::abs(p.z()) < kSameLevel;
  });
}

/// At the wall on one side of a robot, smaller than designed where the drift is narrow.
std::optional<Parked> beside(const Raycaster& floor, const Pose& T_world_base, double side, Thing thing) {
  const Vector3 ahead = T_world_base.rotation() * Vector3::UnitX();
  const double yaw = std::atan2(ahead.y(), ahead.x());
  const Vector3 to_wall(-side * std::sin(yaw), side * std::cos(yaw), 0.0);
  const Vector3 eye = T_world_base.translation() + Vector3(0.0, 0.0, 0.5);
  const RayHit wall =
      floor.cast({eye.cast<float>(), to_wall.cast<float>()}, static_cast<float>(kWidestDrift));
  if (!wall.hit()) return {};
  const double room = static_cast<double>(wall.distance) - kOffTheWall - kPassing;
  const double share = std::min(1.0, room / thing.width);
  if (share < kNarrowest) return {};
  thing.width *= share;
  thing.length *= share;
  const double off = static_cast<double>(wall.distance) - kOffTheWall - thing.width / 2.0;
  const Vector3 at = T_world_base.translation() + off * to_wall;
  const std::optional<double> height = floor_height(floor, at);
  if (!height) return {};
  return Parked{thing, Pose::planar(at.x(), at.y(), yaw, *height)};
}

/// Poses of a path by the share of its length, so that places do not depend on where the robot was slow.
class ByLength {
 public:
  explicit ByLength(const Trajectory& path) : path_(path), driven_(path.size(), 0.0) {
    for (std::size_t i = 1; i < path.size(); ++i)
      driven_[i] = driven_[i - 1] +
                   (path[i].T_world_body.translation() - path[i - 1].T_world_body.translation()).norm();
  }
  [[nodiscard]] double length() const { return driven_.back(); }
  [[nodiscard]] const Pose& at(double share) const {
    const auto found = std::ranges::lower_bound(driven_, share * length());
    return path_[static_cast<std::size_t>(std::min(found - driven_.begin(), std::ssize(path_) - 1))]
        .T_world_body;
  }

 private:
  const Trajectory& path_;
  std::vector<double> driven_;
};

/// Puts `per_km` of them beside `path`, wherever no path of `others` is blocked.
TriangleMesh parked_along(const Raycaster& floor, const Trajectory& path, std::span<const Trajectory> others,
                          const Thing& thing, double per_km, Rng& rng) {
  TriangleMesh mesh;
  const ByLength along(path);
  const auto num = static_cast<int>(std::lround(along.length() / 1000.0 * per_km));
  for (int i = 0; i < num; ++i) {
    for (int attempt = 0; attempt < kTries; ++attempt) {
      const double share = rng.uniform();
      const double side = rng.uniform() < 0.5 ? 1.0 : -1.0;
      const std::optional<Parked> parked = beside(floor, along.at(share), side, thing);
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
  return {{"vehicles_per_km", &c.vehicles_per_km, "1/km", 0, 1000, "vehicles parked along each robot's path"},
          {"pallets_per_km", &c.pallets_per_km, "1/km", 0, 1000, "pallets beside each robot's path"},
          {"changed", &c.changed, "", 0, 1, "share of them that only one robot meets"},
          {"people", &c.people, "", 0, 20, "people who walk with each robot"},
          {"dust", &c.dust, "", 0, 0.5, "share of rays that end in dust near the sensor"}};
}

VisitConfig field_visits() { return {4.0, 8.0, 0.5, 1, 0.002}; }

std::vector<TriangleMesh> parked_things(const Raycaster& floor, std::span<const Trajectory> truths,
                                        const VisitConfig& config, std::uint64_t seed) {
  constexpr std::uint64_t kLasting = 1;
  constexpr std::uint64_t kPassingBy = 2;
  const auto along = [&](std::size_t robot, std::span<const Trajectory> others, double share,
                         std::uint64_t stream) {
    Rng rng(mix64(mix64(seed, stream), robot));
    TriangleMesh mesh =
        parked_along(floor, truths[robot], others, kVehicle, share * config.vehicles_per_km, rng);
    append(mesh, parked_along(floor, truths[robot], others, kPallet, share * config.pallets_per_km, rng));
    return mesh;
  };
  TriangleMesh lasting;
  for (std::size_t robot = 0; robot < truths.size(); ++robot)
    append(lasting, along(robot, truths, 1.0 - config.changed, kLasting));
  std::vector<TriangleMesh> met(truths.size(), lasting);
  for (std::size_t robot = 0; robot < truths.size(); ++robot)
    append(met[robot], along(robot, truths.subspan(robot, 1), config.changed, kPassingBy));
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

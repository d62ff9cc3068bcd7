// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/things.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "adit/simulation/floor_line.hpp"

namespace adit {
namespace {

constexpr double kOffTheWall = 0.15;
constexpr double kNarrowest =
    0.5;  ///< Share of its width and length that a thing may have in a narrow drift.
constexpr double kWidestDrift = 15.0;

double yaw_of(const Pose& T_world_base) {
  const Vector3 ahead = T_world_base.rotation() * Vector3::UnitX();
  return std::atan2(ahead.y(), ahead.x());
}

}  // namespace

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

TriangleMesh mesh_of(const PlacedThing& placed) {
  const auto& [thing, T_world_thing] = placed;
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

bool leaves_room(const PlacedThing& placed, const Pose& robot) {
  constexpr double kSameLevel = 2.0;
  const Thing& thing = placed.thing;
  const Vector3 p = placed.T_world_thing.inverse() * robot.translation();
  const double beside = std::max(std::abs(p.x()) - thing.length / 2.0, std::abs(p.y()) - thing.width / 2.0);
  return beside >= kPassingRoom || std::abs(p.z()) >= kSameLevel;
}

bool leaves_room(const PlacedThing& placed, const Trajectory& path) {
  return std::ranges::all_of(
      path, [&](const StampedPose& robot) { return leaves_room(placed, robot.T_world_body); });
}

Vector3 direction_beside(const Pose& T_world_base, double side) {
  const double yaw = yaw_of(T_world_base);
  return {-side * std::sin(yaw), side * std::cos(yaw), 0.0};
}

RayHit wall_beside(const Raycaster& world, const Pose& T_world_base, double side, double height,
                   double farthest) {
  const Vector3 eye = T_world_base.translation() + Vector3(0.0, 0.0, height);
  return world.cast({eye.cast<float>(), direction_beside(T_world_base, side).cast<float>()},
                    static_cast<float>(farthest));
}

std::optional<PlacedThing> beside(const Raycaster& floor, const Pose& T_world_base, double side,
                                  Thing thing) {
  const RayHit wall = wall_beside(floor, T_world_base, side, 0.5, kWidestDrift);
  if (!wall.hit()) return {};
  const double room = static_cast<double>(wall.distance) - kOffTheWall - kPassingRoom;
  const double share = std::min(1.0, room / thing.width);
  if (share < kNarrowest) return {};
  thing.width *= share;
  thing.length *= share;
  const double off = static_cast<double>(wall.distance) - kOffTheWall - thing.width / 2.0;
  const Vector3 at = T_world_base.translation() + off * direction_beside(T_world_base, side);
  const std::optional<double> height = floor_height(floor, at);
  if (!height) return {};
  return PlacedThing{thing, Pose::planar(at.x(), at.y(), yaw_of(T_world_base), *height)};
}

ByLength::ByLength(const Trajectory& path) : path_(path), driven_(path.size(), 0.0) {
  for (std::size_t i = 1; i < path.size(); ++i)
    driven_[i] =
        driven_[i - 1] + (path[i].T_world_body.translation() - path[i - 1].T_world_body.translation()).norm();
}

const StampedPose& ByLength::at(double share) const {
  const auto found = std::ranges::lower_bound(driven_, share * length());
  return path_[static_cast<std::size_t>(std::min(found - driven_.begin(), std::ssize(path_) - 1))];
}

std::vector<Pose> poses_along(const Trajectory& path, double step) {
  std::vector<Pose> poses;
  double driven = step;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1;
    driven += (path[i].T_world_body.translation() - path[before].T_world_body.translation()).norm();
    if (driven < step) continue;
    poses.push_back(path[i].T_world_body);
    driven = 0.0;
  }
  return poses;
}

}  // namespace adit

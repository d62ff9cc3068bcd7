// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/doors.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "adit/core/rng.hpp"
#include "adit/simulation/things.hpp"

namespace adit {
namespace {

constexpr double kLookStep = 0.5;  ///< Metres along the path, between looks to the side.
constexpr double kLookHeight = 1.2;
constexpr double kFarthestLook = 30.0;
constexpr double kSetBack = 2.5;  ///< From the wall before an opening to what is behind it.
constexpr double kWidestDoor = 8.0;
constexpr double kNarrowestDoor = 1.5;
constexpr double kHighestRoof = 6.0;

/// What one look to the side finds.
struct Look {
  Vector3 eye;
  Vector3 direction;
  double distance;

  [[nodiscard]] Vector3 wall() const { return eye + distance * direction; }
};

std::vector<Look> looks_beside(const Raycaster& floor, const Trajectory& path, double side) {
  std::vector<Look> looks;
  for (const Pose& pose : poses_along(path, kLookStep)) {
    const RayHit hit = wall_beside(floor, pose, side, kLookHeight, kFarthestLook);
    looks.push_back({pose.translation() + Vector3(0.0, 0.0, kLookHeight), direction_beside(pose, side),
                     hit.hit() ? static_cast<double>(hit.distance) : kFarthestLook});
  }
  return looks;
}

double height_of_roof(const Raycaster& floor, const Vector3& eye) {
  const RayHit roof =
      floor.cast({eye.cast<float>(), Eigen::Vector3f::UnitZ()}, static_cast<float>(kHighestRoof));
  return std::min(kHighestRoof, roof.hit() ? static_cast<double>(roof.distance) : kHighestRoof);
}

/// A leaf between two points of a wall, from below the floor to above the roof.
PlacedThing leaf_between(const Raycaster& floor, const Vector3& from, const Vector3& to) {
  constexpr double kThick = 0.1;
  constexpr double kIntoTheWall = 0.3;
  constexpr double kBelowFloor = 0.2;
  const Vector3 middle = 0.5 * (from + to);
  const double yaw = std::atan2(to.y() - from.y(), to.x() - from.x());
  const double height = kLookHeight + height_of_roof(floor, middle) + 2.0 * kBelowFloor;
  const Pose T_world_leaf = Pose::planar(middle.x(), middle.y(), yaw, middle.z() - kLookHeight - kBelowFloor);
  return {{(to - from).norm() + 2.0 * kIntoTheWall, kThick, height, 0.0}, T_world_leaf};
}

TriangleMesh solid(const PlacedThing& placed) {
  const Thing& t = placed.thing;
  return box(placed.T_world_thing, {-t.length / 2.0, -t.width / 2.0, t.ground_clearance},
             {t.length / 2.0, t.width / 2.0, t.height});
}

/// The index behind the opening that begins at `first`, where there is one.
std::optional<std::size_t> end_of_opening(const std::vector<Look>& looks, std::size_t first) {
  const double wall = looks[first - 1].distance;
  std::size_t end = first;
  while (end < looks.size() && looks[end].distance > wall + kSetBack) ++end;
  if (end == first || end == looks.size()) return {};
  const double width = (looks[end].wall() - looks[first - 1].wall()).norm();
  return width >= kNarrowestDoor && width <= kWidestDoor ? std::optional(end) : std::nullopt;
}

}  // namespace

TriangleMesh closed_doors(const Raycaster& floor, const Trajectory& path, double share, std::uint64_t seed) {
  TriangleMesh mesh;
  if (share == 0.0) return mesh;
  Rng rng(seed);
  for (const double side : {1.0, -1.0}) {
    const std::vector<Look> looks = looks_beside(floor, path, side);
    for (std::size_t first = 1; first < looks.size(); ++first) {
      const std::optional<std::size_t> end = end_of_opening(looks, first);
      if (!end) continue;
      const PlacedThing leaf = leaf_between(floor, looks[first - 1].wall(), looks[*end].wall());
      first = *end;
      if (rng.uniform() < share && leaves_room(leaf, path)) append(mesh, solid(leaf));
    }
  }
  return mesh;
}

TriangleMesh blocked_end(const Raycaster& floor, const Trajectory& path) {
  constexpr double kBeyond = 4.0;
  constexpr double kMachineLength = 6.0;
  constexpr double kGap = 0.3;
  constexpr double kWidestEnd = 8.0;
  constexpr double kHighestMachine = 3.0;
  const Pose& end = path.back().T_world_body;
  const Vector3 ahead = end.rotation() * Vector3::UnitX();
  const Vector3 eye = end.translation() + Vector3(0.0, 0.0, kLookHeight);
  const RayHit front = floor.cast({eye.cast<float>(), ahead.cast<float>()}, kBeyond + kMachineLength);
  if (front.hit()) return {};
  const Pose T_world_machine = end * Pose::translation_of(kBeyond + kMachineLength / 2.0, 0.0, 0.0);
  const RayHit left = wall_beside(floor, T_world_machine, 1.0, kLookHeight, kWidestEnd);
  const RayHit right = wall_beside(floor, T_world_machine, -1.0, kLookHeight, kWidestEnd);
  if (!left.hit() || !right.hit()) return {};
  const double to_left = static_cast<double>(left.distance) - kGap;
  const double to_right = static_cast<double>(right.distance) - kGap;
  const double height =
      std::min(kHighestMachine,
               kLookHeight + height_of_roof(floor, T_world_machine * Vector3(0.0, 0.0, kLookHeight)) - kGap);
  const PlacedThing machine{{kMachineLength, to_left + to_right, height, 0.4},
                            T_world_machine * Pose::translation_of(0.0, 0.5 * (to_left - to_right), 0.0)};
  if (to_left + to_right < 1.0 || !leaves_room(machine, path)) return {};
  return solid(machine);
}

}  // namespace adit

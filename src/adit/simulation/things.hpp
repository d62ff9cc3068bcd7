// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Bodies that stand or move in a world, and where along a path there is room for them. Metres.
#pragma once

#include <optional>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/geometry/triangle_mesh.hpp"
#include "adit/simulation/raycaster.hpp"

namespace adit {

/// From the middle of a path to a thing: half a robot, and half a metre.
inline constexpr double kPassingRoom = 0.85;

/// What can stand beside a path: along the wall, across it, above the floor.
struct Thing {
  double length = 1.0;            ///< Along the wall.
  double width = 1.0;             ///< Across it.
  double height = 1.0;            ///< Of its top above the floor.
  double ground_clearance = 0.0;  ///< Of its body above the floor; wheels or feet are below.
};
inline constexpr Thing kVehicle{4.6, 1.9, 2.0, 0.35};  ///< Parked, or driving.
inline constexpr Thing kPallet{1.2, 0.8, 1.1, 0.1};    ///< With its load.

/// Origin on the floor below its middle.
struct PlacedThing {
  Thing thing;         ///< As large as it is there, see beside().
  Pose T_world_thing;  ///< x along it, y to its left, z up.
};

/// Paths that pass nearer than this to a place are taken for paths through its tunnel, metres.
inline constexpr double kSameTunnel = 6.0;

/// A box between two corners in its own frame, its faces looking outwards.
[[nodiscard]] TriangleMesh box(const Pose& T_world_box, const Vector3& low, const Vector3& high);

/// A body on wheels or feet with a cabin at one end.
[[nodiscard]] TriangleMesh mesh_of(const PlacedThing& placed);

/// Whether a robot at that pose (T_world_base) passes the thing.
[[nodiscard]] bool leaves_room(const PlacedThing& placed, const Pose& robot);
/// The same at every pose of a path.
[[nodiscard]] bool leaves_room(const PlacedThing& placed, const Trajectory& path);

/// To the wall on one side (1: left, -1: right) of a robot's heading, at that height above its base frame's
/// origin; kMiss beyond `farthest`.
[[nodiscard]] RayHit wall_beside(const Raycaster& world, const Pose& T_world_base, double side, double height,
                                 double farthest);
/// The level direction to that side.
[[nodiscard]] Vector3 direction_beside(const Pose& T_world_base, double side);

/// The thing at the wall on one side of a robot, smaller than designed where the drift is narrow; none where
/// it has no room. `floor` is watertight (EdgeRule).
[[nodiscard]] std::optional<PlacedThing> beside(const Raycaster& floor, const Pose& T_world_base, double side,
                                                Thing thing);

/// Poses of a path by the share of its length, so that places do not depend on where the robot was slow. The
/// path outlives it.
class ByLength {
 public:
  /// `path` holds a pose or more.
  explicit ByLength(const Trajectory& path);
  [[nodiscard]] double length() const { return driven_.back(); }  ///< Of the whole path, metres.
  /// The first pose at or beyond that share of the length, 0 to 1.
  [[nodiscard]] const StampedPose& at(double share) const;

 private:
  const Trajectory& path_;
  std::vector<double> driven_;
};

/// The poses of a path `step` apart along its length, the first one included.
[[nodiscard]] std::vector<Pose> poses_along(const Trajectory& path, double step);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The building blocks of tunnel worlds: a convex profile swept along a level line. World frame, metres. A
/// solid is used as free space (a tunnel, a passage, a niche) or as matter (a cabinet, a platform).
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "adit/core/pose.hpp"

namespace adit {

/// A convex cross-section, counter-clockwise, as (metres to the left of the line, metres above it).
using Profile = std::vector<Eigen::Vector2d>;
/// Points that straight segments join.
using Polyline = std::vector<Vector3>;

/// Flat floor, upright walls and a half-ellipse above them.
struct Arch {
  double width = 10.0;         ///< From wall to wall.
  double height = 7.0;         ///< Of the crown above the floor.
  double spring_height = 2.0;  ///< Where the walls end and the vault begins.
  int num_facets = 40;         ///< Of the vault. 40 keep a vault of 5 m radius within 4 mm.
};
/// Its floor lies at height 0, its middle on the line.
[[nodiscard]] Profile arch_profile(const Arch& arch);
/// A rectangle from `bottom` to `top` metres above the line, its middle on it.
[[nodiscard]] Profile box_profile(double width, double bottom, double top);
/// The profile moved to the left of its line.
[[nodiscard]] Profile shifted(Profile profile, double left);

/// The points p with normal . p <= offset.
struct HalfSpace {
  Vector3 normal;       ///< Unit length, pointing out of the piece.
  double offset = 0.0;  ///< Metres from the origin.
  /// Positive outside of the piece.
  [[nodiscard]] double distance(const Vector3& p) const { return normal.dot(p) - offset; }
};

/// The intersection of half-spaces. The first `num_walls` planes carry surface; the others are the joints to
/// the neighbouring pieces of the same solid.
struct ConvexPiece {
  std::vector<HalfSpace> planes;  ///< Walls first.
  std::size_t num_walls = 0;      ///< At most the number of planes.
  Eigen::AlignedBox3d box;        ///< Around its corners.
};

/// A convex polygon of the surface; the corners run counter-clockwise as seen from the side `normal` points
/// to.
struct Face {
  std::vector<Vector3> corners;  ///< Three or more, in one plane.
  Vector3 normal;                ///< Of unit length.
};

/// `faces` look into the pieces.
struct Solid {
  std::vector<ConvexPiece> pieces;  ///< Side by side; together they are the solid.
  std::vector<Face> faces;          ///< One per wall of a piece; joints have none.
  Eigen::AlignedBox3d box;          ///< Around all pieces.
};

/// Whether a sweep has a wall at its end.
enum class Ends { open, closed };

/// Sweeps `profile` along a level polyline of at least two points. Neighbouring segments meet in their mitre
/// plane, so that every facet is planar. The line's bends must be wider than the profile.
[[nodiscard]] Solid sweep(const Profile& profile, std::span<const Vector3> line, Ends ends);

/// From the point `first` of a line to its point `last`.
struct LinePart {
  std::size_t first = 0;      ///< Index of a point.
  std::size_t last = 1;       ///< The same, behind `first`.
  Ends begin = Ends::closed;  ///< At `first`.
  Ends end = Ends::closed;    ///< At `last`.
};
/// A part of such a sweep. Two parts that share a point of the line meet there in the same corners, to the
/// last bit.
[[nodiscard]] Solid sweep_part(const Profile& profile, std::span<const Vector3> line, const LinePart& part);

/// A room over a convex polygon (counter-clockwise, at least three corners, metres) from z = 0 to `height`.
[[nodiscard]] Solid upright_prism(std::span<const Eigen::Vector2d> corners, double height);

/// Closed sweep of a rectangle along the straight line from `from` to `to`.
[[nodiscard]] Solid box_between(const Vector3& from, const Vector3& to, const Profile& profile);

/// Matter: the same solid with its faces looking outwards.
[[nodiscard]] Solid turned_out(Solid solid);

/// A lower bound on the distance in metres from `point` to the walls of the union of `spaces`; negative
/// outside. Joints between pieces do not count.
[[nodiscard]] double depth_inside(std::span<const Solid> spaces, const Vector3& point);
/// A lower bound on the distance in metres from `point` to the nearest of `obstacles`; negative inside one.
[[nodiscard]] double distance_to(std::span<const Solid> obstacles, const Vector3& point);

}  // namespace adit

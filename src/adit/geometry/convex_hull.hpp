// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace adit {

/// What the points of a cloud span, exactly: a tilted plane whose coordinates were rounded is a thin solid.
enum class HullShape { empty, point, segment, planar, solid };

/// The convex hull of a cloud.
struct ConvexHull {
  HullShape shape = HullShape::empty;
  /// The extreme points, as indices into the cloud, ascending; points inside a face or an edge are none, so
  /// that a wall counts the same however densely it was sampled.
  std::vector<std::uint32_t> vertices;
  /// The surface of a solid hull (no others have one): indices, counter-clockwise seen from outside. Where
  /// faces are flat its corners may include points that are no `vertices`.
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Quickhull in 3-D with exact predicates: coordinates are rounded to a grid of 2^-24 of the largest (the
/// resolution of a float of that size), and from there on no decision depends on rounding, so that
/// duplicates, grids of coplanar points, planes and lines need no tolerance. Points that are not finite are
/// left out; of duplicates one is taken. Equal input gives equal bytes. Expected time O(n log h) for h
/// vertices. Source: Barber, Dobkin, Huhdanpaa, "The Quickhull algorithm for convex hulls", 1996.
[[nodiscard]] ConvexHull convex_hull(std::span<const Eigen::Vector3f> points);

/// Volume enclosed by a solid hull, cubic metres; 0 for every other shape.
[[nodiscard]] double volume(const ConvexHull& hull, std::span<const Eigen::Vector3f> points);

}  // namespace adit

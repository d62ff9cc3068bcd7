// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace adit {

/// Dimension of the smallest flat that holds a cloud, to the rounding of its coordinates.
enum class HullShape { empty, point, segment, planar, solid };

/// The convex hull of a cloud. `vertices` are indices into the points, ascending; `triangles` (of a solid
/// hull alone) are triples of indices, counter-clockwise seen from outside.
struct ConvexHull {
  HullShape shape = HullShape::empty;
  std::vector<std::uint32_t> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Quickhull in 3-D (Barber, Dobkin, Huhdanpaa 1996). Points within `tolerance` metres of a face count as
/// inside; 0 means the rounding of the coordinates (about 1e-7 of the largest). Of duplicates the first is
/// taken. Points that are not finite are left out. A planar or collinear cloud gives its hull in that plane
/// or line. Equal input gives equal bytes; the expected time is O(n log h) for h vertices.
[[nodiscard]] ConvexHull convex_hull(std::span<const Eigen::Vector3f> points, double tolerance = 0.0);

/// Volume enclosed by a solid hull, cubic metres; 0 for every other shape.
[[nodiscard]] double volume(const ConvexHull& hull, std::span<const Eigen::Vector3f> points);

}  // namespace adit

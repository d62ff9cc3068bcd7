// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "adit/core/result.hpp"

namespace adit {

/// What the points of a cloud span. A cloud counts as flat or straight where it is thinner than its
/// coordinates resolve as floats.
enum class HullShape { point, segment, planar, solid };

/// The convex hull of a cloud.
struct ConvexHull {
  HullShape shape = HullShape::point;  ///< How many dimensions the vertices span.
  /// The extreme points, as indices into the cloud, ascending. Points inside a face or an edge are left out,
  /// so that a wall counts the same however densely it was sampled.
  std::vector<std::uint32_t> vertices;
};

/// The hull of the finite points, in any order and number; of duplicates one is taken. Planes and lines are
/// hulls of two and one dimensions. Equal input gives equal bytes. Expected time O(n log h) for h vertices.
/// Errors: no point is finite. Source: Barber, Dobkin, Huhdanpaa, "The Quickhull algorithm for convex hulls",
/// 1996, by its authors' library Qhull, without joggling.
[[nodiscard]] Result<ConvexHull> convex_hull(std::span<const Eigen::Vector3f> points);

}  // namespace adit

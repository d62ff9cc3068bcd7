// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A plan: what a map looks like from above, as a raster that figures draw.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/geometry/triangle_mesh.hpp"

namespace adit {

/// Row-major raster over the xy plane; row 0 is the southern edge (smallest y). Empty when width is 0.
struct FloorPlan {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< South-western corner of cell (0, 0), metres.
  double cell_m = 0.0;                               ///< Edge of a cell.
  int width = 0;                                     ///< Columns, from west to east.
  int height = 0;                                    ///< Rows, from south to north.
  std::vector<float> density;                        ///< Share of ink in a cell, 0 to 1.

  /// Whether there is no cell, as of an empty mesh or cloud.
  [[nodiscard]] bool empty() const { return density.empty(); }
  /// Density of a cell, which must exist.
  [[nodiscard]] float at(int column, int row) const {
    return density[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                   static_cast<std::size_t>(column)];
  }
};

/// The walls of a mesh: triangles steeper than 45 degrees, weighted by how much wall stands on a cell. The
/// cell is at least `cell_m` and grows until the raster has at most 4 million cells.
[[nodiscard]] FloorPlan floor_plan_of(const TriangleMesh& mesh, double cell_m = 0.25);

/// The density of points over each cell. A tunnel's wall piles many points on few cells, its floor few on
/// many; the scale is logarithmic so that both stay visible. Points that are not finite do not count.
[[nodiscard]] FloorPlan floor_plan_of(std::span<const Eigen::Vector3f> points, double cell_m = 0.25);

}  // namespace adit

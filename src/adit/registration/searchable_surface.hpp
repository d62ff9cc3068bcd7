// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <utility>

#include "adit/core/pose.hpp"
#include "adit/geometry/point_grid.hpp"
#include "adit/registration/oriented_points.hpp"

namespace adit {

/// Surfaces that were seen from one point, with the grid that finds the nearest point of them.
class SearchableSurface {
 public:
  /// `points` and `viewpoint`, where the sensor stood, in the same frame, metres.
  /// `voxel_m`: points are one per voxel of this edge.
  SearchableSurface(OrientedPoints points, const Vector3& viewpoint, double voxel_m)
      : points_(std::move(points)),
        grid_(points_.points, kCellVoxels * voxel_m),
        viewpoint_(viewpoint.cast<float>()) {}

  /// All of them, as given.
  [[nodiscard]] const OrientedPoints& points() const { return points_; }
  /// Finds indices of `points`.
  [[nodiscard]] const PointGrid& grid() const { return grid_; }
  /// Where the sensor stood, in the frame of the points, metres.
  [[nodiscard]] const Eigen::Vector3f& viewpoint() const { return viewpoint_; }
  /// About what this takes, grid included.
  [[nodiscard]] std::size_t num_bytes() const {
    return 2 * points_.size() * sizeof(Eigen::Vector3f) + points_.intensities.size() * sizeof(float) +
           grid_.num_bytes();
  }

 private:
  OrientedPoints points_;
  PointGrid grid_;
  Eigen::Vector3f viewpoint_;
};

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Surface normals from the scatter of each point's surroundings.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "adit/geometry/radius_search.hpp"

namespace adit {

/// The surface around a point, from the scatter of its surroundings with eigenvalues l1 >= l2 >= l3.
struct SurfacePoint {
  Eigen::Vector3f normal =
      Eigen::Vector3f::Zero();  ///< Unit length, turned to the sensor; zero: not `valid`.
  float linearity = 0.0F;       ///< (l1 - l2) / l1: 1 along a wire.
  float planarity = 0.0F;       ///< (l2 - l3) / l1: 1 on a plane.
  bool valid =
      false;  ///< False with fewer than 3 neighbours, or when all of them lie on one line with the point.
};

/// One result per point, from the point and its neighbours no farther than `radius` metres among `pairs`
/// (found with at least that radius). Normals are turned to the origin of the points' frame, where the sensor
/// is.
[[nodiscard]] std::vector<SurfacePoint> estimate_surface(const std::vector<Eigen::Vector3f>& points,
                                                         const NeighborPairs& pairs, float radius);

/// Unit normals turned to the origin; zero where a point has no valid surface within `radius` metres.
[[nodiscard]] std::vector<Eigen::Vector3f> estimate_normals(const std::vector<Eigen::Vector3f>& points,
                                                            float radius);

}  // namespace adit

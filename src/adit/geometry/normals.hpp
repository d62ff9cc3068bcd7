// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/geometry/radius_search.hpp"

namespace adit {

/// What the covariance of a point's surroundings says. Eigenvalues l1 >= l2 >= l3 of the scatter of its
/// neighbours.
struct SurfacePoint {
  Eigen::Vector3f normal =
      Eigen::Vector3f::Zero();  ///< Unit length, pointing to the sensor; zero: not `valid`.
  float linearity = 0.0F;       ///< (l1 - l2) / l1: 1 along a wire.
  float planarity = 0.0F;       ///< (l2 - l3) / l1: 1 on a plane.
  bool valid = false;           ///< False with fewer than 3 neighbours, or when all of them lie on one line.
};

/// One surface point for each point, from its neighbours (and itself) no farther than `radius` metres among
/// those in `neighborhoods`; `sensor` is where the points were seen from, in their frame.
[[nodiscard]] std::vector<SurfacePoint> estimate_surface(
    const std::vector<Eigen::Vector3f>& points, const Neighborhoods& neighborhoods, float radius,
    const Eigen::Vector3f& sensor = Eigen::Vector3f::Zero());

/// Unit normals of a cloud seen from the origin; zero where a point has too few neighbours within `radius`
/// metres.
[[nodiscard]] std::vector<Eigen::Vector3f> estimate_normals(const std::vector<Eigen::Vector3f>& points,
                                                            float radius);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Point-to-plane refinement of a coarse pose (Chen and Medioni, 1992) with a robust kernel. Clouds and poses
/// are in metres.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/geometry/point_grid.hpp"
#include "adit/registration/oriented_points.hpp"
#include "adit/registration/registration_config.hpp"

namespace adit {

/// A point of b with its nearest point of a.
struct PointPair {
  std::uint32_t a = 0;  ///< Index in cloud a.
  std::uint32_t b = 0;  ///< Index in cloud b.
  bool operator==(const PointPair&) const = default;
};

/// The nearest point of a for every point of b, where there is one within `max_distance` metres.
[[nodiscard]] std::vector<PointPair> associate(const PointGrid& grid_a, const OrientedPoints& b,
                                               const Pose& T_a_b, double max_distance);

/// The pose that minimises the robust (Geman-McClure) sum of squared plane residuals near `T_a_b`, by
/// Gauss-Newton. Damped, so that along a direction that the surfaces leave open the pose stays where the
/// guess put it.
[[nodiscard]] Pose align_to_planes(const OrientedPoints& a, const PointGrid& grid_a, const OrientedPoints& b,
                                   const Pose& T_a_b, const RegistrationConfig& config);

/// The same to some millimetres, from fewer points: a start for `align_to_planes`.
struct Approach {
  Pose T_a_b;                ///< Where the steps ended.
  bool has_arrived = false;  ///< The last step [m; rad] was shorter than 0.01: a minimum is near.
};
/// `refine_max_iterations` or too few pairs may end it before it has arrived.
[[nodiscard]] Approach approach_planes(const OrientedPoints& a, const PointGrid& grid_a,
                                       const OrientedPoints& b, const Pose& T_a_b,
                                       const RegistrationConfig& config);

/// The best of several such minima around `T_a_b`. One start is not enough: where the rings of a spinning
/// sensor lock onto one another there are narrow false minima.
[[nodiscard]] Pose refine_point_to_plane(const OrientedPoints& a, const PointGrid& grid_a,
                                         const OrientedPoints& b, const Pose& T_a_b,
                                         const RegistrationConfig& config);

}  // namespace adit

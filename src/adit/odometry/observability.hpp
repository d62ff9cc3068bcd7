// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Planes of the local map around a scan's points, and what they say about how well the scene fixes the pose.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "adit/odometry/local_map.hpp"

namespace adit {

/// A plane that points of the map lie on.
struct MapPlane {
  Vector3 point;
  Vector3 normal;  ///< Unit length; its sign is chance.
};

struct PlaneLimits {
  double radius = 1.0;     ///< Of the patch, voxels (at most one).
  double thickness = 1.0;  ///< Of the patch, variance along the normal over that of its second extent.
};

/// The plane of the map's points around `place`. None where they are too few, on a line (one scan ring: the
/// normal is chance) or scattered.
[[nodiscard]] std::optional<MapPlane> plane_at(const LocalMap& map, const Eigen::Vector3f& place,
                                               const PlaneLimits& limits);

/// The distance of a scan's point from a plane of the map, and its derivative by a right perturbation of
/// T_map_base.
struct PlaneRow {
  Vector6 jacobian;
  double residual = 0.0;
};
/// `point` in the base frame; R_map_base, t_map_base: the pose.
[[nodiscard]] PlaneRow plane_row(const Vector3& point, const MapPlane& plane, const Matrix3& R_map_base,
                                 const Vector3& t_map_base);

/// How well the scene fixes the pose. Point-to-point residuals hide open directions (two samplings of one
/// smooth wall always leave residuals along it), so this looks at the normals of the map around the
/// correspondences: point-to-plane information with the variance of the residuals along the normals, and
/// nothing along open directions.
struct Observability {
  Matrix6 information = Matrix6::Zero();  ///< Of T_map_base, right perturbation.
  /// Smallest eigenvalue of the mean information a correspondence, with rotations about each body axis
  /// measured by the displacement at the scene's root-mean-square distance from it: 0 is open, 1/3 as good as
  /// can be.
  double weakest = 0.0;
  bool degenerate = true;  ///< `weakest` is below `degeneracy_threshold`.
};
/// Of some of the source points, those whose nearest neighbour in the map is nearer than `max_distance`.
[[nodiscard]] Observability observability(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                                          const Pose& T_map_base, double max_distance,
                                          double degeneracy_threshold);
/// Of rows at hand, each of which speaks for `weight` correspondences.
[[nodiscard]] Observability observability(const std::vector<PlaneRow>& rows,
                                          std::span<const Eigen::Vector3f> source, double weight,
                                          double degeneracy_threshold);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Planes of the local map around a scan's points, and what they say about how well the scene fixes the pose.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "adit/geometry/point_to_plane.hpp"
#include "adit/odometry/local_map.hpp"

namespace adit {

/// Which patches of the map count as planes.
struct PlaneLimits {
  double radius = 1.0;     ///< Of the patch, voxels (at most one).
  double thickness = 1.0;  ///< Largest variance along the normal, as a share of that along the second axis.
};

/// The plane through the map's points around `place` (map frame, metres); the sign of its normal is
/// arbitrary. None where the points are too few, lie on a line (one scan ring, whose normal is arbitrary) or
/// are scattered.
[[nodiscard]] std::optional<Plane> plane_at(const LocalMap& map, const Eigen::Vector3f& place,
                                            const PlaneLimits& limits);

/// How well the scene fixes the pose. Point-to-point residuals hide open directions (two samplings of one
/// smooth wall always leave residuals along it), so this looks at the normals of the map around the
/// correspondences: point-to-plane information with the variance of the residuals along the normals, and
/// nothing along open directions.
struct Observability {
  Matrix6 information = Matrix6::Zero();  ///< Of T_map_base, right perturbation.
  /// Smallest eigenvalue of the mean information per correspondence, with rotations about each body axis
  /// measured by the displacement at the scene's root-mean-square distance from it: 0 is open, 1/3 the best
  /// possible.
  double weakest = 0.0;
  bool degenerate = true;  ///< `weakest` is below `degeneracy_threshold`.
  /// Takes the open directions out of a step of T_map_base: the projection onto those that the scene fixes.
  Matrix6 onto_fixed = Matrix6::Zero();
};
/// From a sample of the source points (base frame), those whose nearest neighbour in the map is nearer than
/// `max_distance` metres.
[[nodiscard]] Observability observability(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                                          const Pose& T_map_base, double max_distance,
                                          double degeneracy_threshold);
/// From given residuals, each of which represents `weight` correspondences.
[[nodiscard]] Observability observability(const std::vector<PlaneResidual>& residuals,
                                          std::span<const Eigen::Vector3f> source, double weight,
                                          double degeneracy_threshold);

/// What the residuals at the end say of the pose, within the directions that are fixed (`onto_fixed`): rough
/// walls and planes that are slightly off make neighbours err alike, so that residuals count by regions of
/// the scene. `points`: of each residual, base frame. Source: the cluster-robust ("sandwich") covariance of
/// K.-Y. Liang and S. L. Zeger, "Longitudinal data analysis using generalized linear models" (Biometrika
/// 1986), inverted.
[[nodiscard]] Matrix6 information_by_regions(const std::vector<PlaneResidual>& residuals,
                                             std::span<const Eigen::Vector3f> points,
                                             const Matrix6& onto_fixed);

}  // namespace adit

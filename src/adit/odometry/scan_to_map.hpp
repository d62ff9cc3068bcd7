// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What both odometries share: settings, point-to-point alignment of a thinned scan with the local map, and
/// the judgement on how well the scene fixes the pose.
#pragma once

#include <span>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/odometry/local_map.hpp"

namespace adit {

/// Defaults of KISS-ICP 1.2; its rule for the voxel is max_range / 100.
struct ScanToMapConfig {
  double voxel_size = 1.0;
  double max_range = 100.0;
  double min_range = 0.0;
  int max_points_per_voxel = 20;
  bool deskew = true;
  int max_iterations = 500;
  double convergence = 1e-4;
  int min_correspondences = 30;
  double max_correction = 10.0;
  double degeneracy_threshold = 0.01;
};

inline Fields fields_of(ScanToMapConfig& c) {
  return {
      {"voxel_size", &c.voxel_size, "m", 0.01, 10.0,
       "edge of a map voxel; scans are thinned to 0.5 and 1.5 of it"},
      {"max_range", &c.max_range, "m", 1.0, 1000.0, "points beyond are dropped, and so is the map beyond it"},
      {"min_range", &c.min_range, "m", 0.0, 100.0, "points nearer are dropped"},
      {"max_points_per_voxel", &c.max_points_per_voxel, "", 1, 200, "points kept in a map voxel"},
      {"deskew", &c.deskew, "", 0, 1, "remove the motion within the sweep where points carry times"},
      {"max_iterations", &c.max_iterations, "", 1, 10000, "Gauss-Newton iterations a scan, at most"},
      {"convergence", &c.convergence, "", 1e-9, 1.0,
       "norm of the last step [m; rad] at which iterating stops"},
      {"min_correspondences", &c.min_correspondences, "", 6, 100000, "fewer leave the scan unregistered"},
      {"max_correction", &c.max_correction, "m", 0.01, 1000.0,
       "a larger one of the prediction counts as diverged"},
      {"degeneracy_threshold", &c.degeneracy_threshold, "", 0.0, 0.33,
       "share of the normals' information (1/3 = even) below which a direction counts as open"}};
}

/// One source point and its nearest map point.
struct Correspondence {
  Vector3 source;    ///< p, base frame.
  Vector3 residual;  ///< R^T (T p - q), base frame: a right perturbation then has the Jacobian [I, -hat(p)].
};

/// Normal equations of a Gauss-Newton step in N unknowns, and the unweighted sum of squared residuals.
template <int N>
struct NormalEquations {
  Eigen::Matrix<double, N, N> H = Eigen::Matrix<double, N, N>::Zero();
  Eigen::Matrix<double, N, 1> g = Eigen::Matrix<double, N, 1>::Zero();
  double squared_residuals = 0.0;
  int num_correspondences = 0;

  NormalEquations& operator+=(const NormalEquations& other) {
    H += other.H;
    g += other.g;
    squared_residuals += other.squared_residuals;
    num_correspondences += other.num_correspondences;
    return *this;
  }
};

/// KISS-ICP eq. (10)-(11): point-to-point with the Geman-McClure weight (k / (k + r^2))^2, in the tangent of
/// a right perturbation of T_map_base.
[[nodiscard]] NormalEquations<6> linearize_rigid(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                                                 const Pose& T_map_base, double max_distance,
                                                 double kernel_scale);

/// Kinematic-ICP (Guadagnino et al., ICRA 2025), section III-B: the same residual, unweighted, in the two
/// motions of a vehicle that does not slip sideways: forward and about its z axis.
[[nodiscard]] NormalEquations<2> linearize_unicycle(std::span<const Eigen::Vector3f> source,
                                                    const LocalMap& map, const Pose& T_map_base,
                                                    double max_distance);

/// The pose a vehicle reaches that drives `distance` along an arc on which its heading turns by `turn`: exact
/// for every turn, 0 included.
[[nodiscard]] Pose unicycle_motion(double distance, double turn);

/// How well the scene fixes the pose. Point-to-point residuals hide open directions (any two samplings of a
/// smooth wall have residuals along it), so this looks at the normals of the map around the correspondences:
/// point-to-plane information with the residuals' variance along the normals, its open directions (share
/// below `degeneracy_threshold`) set to zero.
struct Observability {
  Matrix6 information = Matrix6::Zero();  ///< Of T_map_base, right perturbation.
  double weakest =
      0.0;  ///< Smallest eigenvalue of the normalised information (its trace is 2: 1 each for t and R).
  bool degenerate = true;
};
[[nodiscard]] Observability observability(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                                          const Pose& T_map_base, double max_distance,
                                          double degeneracy_threshold);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What all odometries share: settings, point-to-point alignment of a thinned scan with the local map, and
/// the step that they report. Points are metres in the base frame, poses T_map_base.
#pragma once

#include <span>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/odometry/correspondences.hpp"
#include "adit/odometry/local_map.hpp"
#include "adit/odometry/observability.hpp"

namespace adit {

/// How a scan is thinned, aligned with the local map and judged. The defaults are those of KISS-ICP 1.2 (its
/// rule for the voxel is max_range / 100); each odometry lists in its own configuration what it sets
/// otherwise.
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
  double max_turn_deg = 180.0;
  double degeneracy_threshold = 0.01;
};

/// The keys are the names of the fields.
[[nodiscard]] Fields fields_of(ScanToMapConfig& config);

/// Normal equations of a Gauss-Newton step in N unknowns, and the unweighted sum of squared residuals.
template <int N>
struct ScanEquations {
  /// Sum of J^T W J.
  Eigen::Matrix<double, N, N> H = Eigen::Matrix<double, N, N>::Zero();
  /// Sum of J^T W r: the step x solves H x = -g.
  Eigen::Matrix<double, N, 1> g = Eigen::Matrix<double, N, 1>::Zero();
  double squared_residuals = 0.0;  ///< Square metres.
  int num_correspondences = 0;     ///< Whose residuals were summed.

  /// Of the residuals of both.
  ScanEquations& operator+=(const ScanEquations& other) {
    H += other.H;
    g += other.g;
    squared_residuals += other.squared_residuals;
    num_correspondences += other.num_correspondences;
    return *this;
  }
};

/// KISS-ICP eq. (10)-(11): point-to-point with the Geman-McClure weight (k / (k + r^2))^2, in the tangent of
/// a right perturbation of T_map_base.
[[nodiscard]] ScanEquations<6> linearize_rigid(Correspondences& pairs, const Pose& T_map_base,
                                               double kernel_scale);

/// Kinematic-ICP (Guadagnino et al., ICRA 2025), section III-B: the same residual, unweighted, in the two
/// motions of a vehicle that does not slip sideways: forward and about its z axis.
[[nodiscard]] ScanEquations<2> linearize_unicycle(Correspondences& pairs, const Pose& T_map_base);

/// Where iterating ended. With too few correspondences or after divergence the pose is the prediction.
struct Alignment {
  Pose T_map_base;                     ///< Where the scan was taken.
  StepStatus status = StepStatus::ok;  ///< ok, too_few_points or diverged.
  int num_correspondences = 0;         ///< Points with a counterpart in the map, at the end.
  int iterations = 0;                  ///< Of Gauss-Newton, those of a coarse start included.
};

/// Whether a correction of the prediction is one that the odometry believes.
[[nodiscard]] bool is_within_trust(const Pose& correction, const ScanToMapConfig& config);

/// Gauss-Newton on `linearize_rigid` from the prediction; `sigma` is the kernel's scale and correspondences
/// reach to 3 sigma.
[[nodiscard]] Alignment align_point_to_point(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                                             const Pose& T_prediction, double sigma,
                                             const ScanToMapConfig& config);

/// Gauss-Newton on `linearize_unicycle` from the prediction. The forward step is damped by beta = 1 / (mean
/// squared residual at the prediction), so the better the wheels already fit the scene, the more they are
/// trusted. A prediction that is not `by_wheels` is hardly trusted: beta is 0.05.
[[nodiscard]] Alignment align_unicycle(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                                       const Pose& T_prediction, double max_distance,
                                       const ScanToMapConfig& config, bool by_wheels = true);

/// A scan thinned twice (KISS-ICP, section III-B), metres, base frame.
struct ThinnedScan {
  std::vector<Eigen::Vector3f> map_points;  ///< One point per cube of half a voxel: what the map takes.
  std::vector<Eigen::Vector3f> source;      ///< Of those one per cube of 1.5 voxels: what is registered.
};
/// Each cube keeps its first point, in the order of the cloud. `voxel_size`: that of the map, metres;
/// `thinner` gives the memory.
[[nodiscard]] ThinnedScan thinned_twice(std::span<const Eigen::Vector3f> points_base, double voxel_size,
                                        VoxelThinner& thinner);

/// The step of a scan that finds the map empty: it starts the map unless it has too few points for that.
[[nodiscard]] OdometryStep first_step(const ThinnedScan& scan, const Pose& T_prediction,
                                      const ScanToMapConfig& config);

/// The step of an aligned scan: diagnosis and information added to a registered pose.
[[nodiscard]] OdometryStep step_of(const Alignment& alignment, std::span<const Eigen::Vector3f> source,
                                   const LocalMap& map, double max_distance, const ScanToMapConfig& config);

/// Whether a scan with this status enters the map: it was registered, or it starts the map.
[[nodiscard]] inline bool enters_map(StepStatus status) {
  return status == StepStatus::ok || status == StepStatus::degenerate || status == StepStatus::no_map;
}

/// Adds the scan at the step's pose, if it enters the map, and drops what is out of range of that pose. A
/// robot that has left its map behind finds it empty and starts a new one at the prediction.
void update_map(LocalMap& map, const ThinnedScan& scan, const OdometryStep& step,
                const ScanToMapConfig& config);

}  // namespace adit

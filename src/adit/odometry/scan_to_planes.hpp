// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Point-to-plane alignment of a thinned scan with the local map, with the wheels' prediction as a prior.
#pragma once

#include <span>

#include "adit/core/config.hpp"
#include "adit/odometry/scan_to_map.hpp"

namespace adit {

/// What is known of a scan's pose before it is looked at.
struct PosePrior {
  Pose T_map_base;                        ///< The prediction.
  Matrix6 information = Matrix6::Zero();  ///< Of it, right perturbation [translation; rotation].
  double usual_share = 0.0;               ///< Share of the points of earlier scans that lay near a plane.
};

/// Normal equations of the prior's cost, half of d^T information d with d = log(prior^-1 T_map_base), in the
/// tangent of a right perturbation of T_map_base.
[[nodiscard]] ScanEquations<6> linearize_prior(const PosePrior& prior, const Pose& T_map_base);

/// Where `align_point_to_plane` ended. After a failure `information` and `share_near` are zero.
struct PlaneAlignment : Alignment {
  Observability seen;                     ///< What the scan alone says about the pose.
  Matrix6 information = Matrix6::Zero();  ///< Of the residuals at the end, as if all were independent.
  double share_near = 0.0;                ///< Share of the source points that lie near a plane of the map.
};

/// Minimises the squared distances of the scan's points from the planes of the map around them
/// (Geman-McClure, scale `3 sigma`, metres) and of the pose from the prior: Gauss-Newton in all six
/// directions. Neither a line of points (one scan ring) nor a scatter of them is a plane, so that in a smooth
/// tube nothing is measured along its axis and the wheels decide there.
///
/// Where less than nine tenths of `prior.usual_share` of the points lie near a plane, the prediction is poor
/// (a kerb, a ramp), and point-to-point ICP brings the scan near first.
///
/// `too_few_points` where fewer than `min_correspondences` points lie near a plane, `diverged` where the
/// correction of the prediction is beyond `max_correction` or `max_turn_deg`.
[[nodiscard]] PlaneAlignment align_point_to_plane(std::span<const Eigen::Vector3f> source,
                                                  const LocalMap& map, const PosePrior& prior, double sigma,
                                                  const ScanToMapConfig& config);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Point-to-plane alignment of a thinned scan with the local map, with the wheels' prediction as a prior.
#pragma once

#include <span>

#include "adit/core/config.hpp"
#include "adit/odometry/scan_to_map.hpp"

namespace adit {

/// Standard deviations of the wheels' motion between two scans, per metre driven. Wheels that measure in a
/// plane know nothing of climbing and tilting; there the figures are those of a rough floor.
struct WheelNoise {
  double slip = 0.02;        ///< Forward, metres per metre.
  double sideways = 0.01;    ///< Metres per metre.
  double climb = 0.25;       ///< Metres per metre.
  double tilt_deg = 10.0;    ///< Roll and pitch, degrees per metre.
  double heading_deg = 0.5;  ///< Degrees per metre.
  double turn = 0.05;        ///< Heading again, share of the angle turned.
};
[[nodiscard]] Fields fields_of(WheelNoise& noise);

/// Information of the pose T_map_base that the wheels predict after the motion `T_last_now` (T_base0_base1);
/// right perturbation, [translation; rotation].
[[nodiscard]] Matrix6 wheel_information(const WheelNoise& noise, const Pose& T_last_now);

/// What is known of a scan's pose before it is looked at.
struct PosePrior {
  Pose T_map_base;                        ///< The wheels' prediction.
  Matrix6 information = Matrix6::Zero();  ///< Of it, right perturbation [translation; rotation].
  double usual_share = 0.0;               ///< Share of the points of earlier scans that lay near a plane.
};

struct PlaneAlignment : Alignment {
  Observability seen;       ///< What the scan alone says about the pose.
  double share_near = 0.0;  ///< Share of the source points that lie near a plane of the map.
};

/// Minimises the squared distances of the scan's points from the planes of the map around them
/// (Geman-McClure, scale `3 sigma`, metres) and of the pose from the prior: Gauss-Newton in all six
/// directions. Neither a line of points (one scan ring) nor a scatter of them is a plane, so that in a smooth
/// tube nothing is measured along its axis and the wheels decide there.
///
/// Where less than nine tenths of `prior.usual_share` of the points lie near a plane, the prediction is poor
/// (a kerb, a ramp), and point-to-point ICP brings the scan near first.
[[nodiscard]] PlaneAlignment align_point_to_plane(std::span<const Eigen::Vector3f> source,
                                                  const LocalMap& map, const PosePrior& prior, double sigma,
                                                  const ScanToMapConfig& config);

}  // namespace adit

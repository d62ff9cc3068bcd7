// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Point-to-plane alignment of a thinned scan with the local map, held by what the wheels say.
#pragma once

#include <span>

#include "adit/core/config.hpp"
#include "adit/odometry/scan_to_map.hpp"

namespace adit {

/// How far the motion between two scans may differ from what the wheels say: standard deviations that grow
/// with the distance driven. Wheels that measure in a plane say nothing about climbing and tilting; there the
/// figures are those of a rough floor.
struct WheelNoise {
  double slip = 0.02;
  double sideways = 0.01;
  double climb = 0.25;
  double tilt_deg = 10.0;
  double heading_deg = 0.5;
  double turn = 0.05;
};
Fields fields_of(WheelNoise& noise);

/// Information of the pose T_map_base that the wheels predict, right perturbation, after the motion
/// `T_last_now`.
[[nodiscard]] Matrix6 wheel_information(const WheelNoise& noise, const Pose& T_last_now);

struct PlaneAlignment : Alignment {
  Observability seen;       ///< What the scan alone says about the pose.
  double share_near = 0.0;  ///< Of the source points, those that lie near a plane of the map.
};

/// Minimises the squared distances of the scan's points from the planes of the map around them
/// (Geman-McClure, scale `3 sigma`) and of the pose from the prediction, weighted by `information`: Gauss-
/// Newton in all six directions. Neither a line of points (one scan ring) nor a scatter of them is a plane,
/// so that in a smooth tube nothing is measured along its axis and the wheels decide there.
///
/// Where less than nine tenths of `usual_share` of the points lie near a plane, the prediction is poor (a
/// kerb, a ramp), and point-to-point ICP finds the way first.
[[nodiscard]] PlaneAlignment align_planes(std::span<const Eigen::Vector3f> source, const LocalMap& map,
                                          const Pose& T_prediction, const Matrix6& information, double sigma,
                                          double usual_share, const ScanToMapConfig& config);

}  // namespace adit

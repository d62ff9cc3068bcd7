// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The frame of surveyed points, from points that are known in two frames and of which some may be blunders.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// Points known in two frames; vectors of one length. Errors in the source frame may depend on one another,
/// as those of marks in a map that drifts do.
struct ControlPairs {
  std::vector<std::string> names;     ///< As errors call the points.
  std::vector<Vector3> target;        ///< Metres; may be as large as national coordinates are.
  std::vector<Vector3> target_sigma;  ///< Standard deviation along each axis, metres, more than 0.
  std::vector<Vector3> source;        ///< Metres.
  Eigen::MatrixXd source_covariance;  ///< Of all points, x y z of each in turn, m^2.
  std::vector<bool> is_check;         ///< A check point has no say, and is judged like the others.
};

/// The motion that fits the points, how well it is known, and how each of them fits.
struct ControlFit {
  Pose T_target_source;                  ///< Brings source points to target points, in coordinates as given.
  Matrix6 covariance = Matrix6::Zero();  ///< Of T_target_source, right perturbation, [translation; rotation].
  std::vector<bool> used;                ///< Of each point.
  std::vector<Vector3> residuals;        ///< target - T_target_source * source of each point, metres.
  /// Of each point the squared distance between where it is and where all other used points expect it, over
  /// the covariance of that distance: chi-square with 3 degrees of freedom. None where too few others are
  /// left to say.
  std::vector<std::optional<double>> misfits;
  double chi2 = 0.0;         ///< Of the points in use.
  int redundancy = 0;        ///< Numbers measured minus unknowns.
  double scale = 1.0;        ///< Of the target frame to the source frame, by the points in use; not applied.
  double scale_sigma = 0.0;  ///< Standard deviation of `scale`.
  /// The error of T_target_source, right perturbation, by those of the points in use: 6 x 3n, zero columns
  /// for the others. Its factor is the error of target - T_target_source * source.
  Eigen::MatrixXd gain;
};

/// A point whose misfit is beyond this is a blunder: chi2inv(0.999, 3).
inline constexpr double kControlBound = 16.266;
/// A rotation known worse than this, radians, counts as unknown: beyond it nothing here is linear.
inline constexpr double kWorstControlRotation = 0.1;

/// Both frames have z up: what tilts one against the other by more than this, radians, is no answer.
inline constexpr double kMostControlTilt = 0.8;

/// The rigid motion that fits best by generalised least squares, without the points that contradict it.
/// The start is the best of all triples by truncated least squares (of 3000 drawn ones where there are more);
/// then points enter and leave one at a time until those in use are all those whose misfit is within
/// `kControlBound`. Misfits are the prediction residuals of universal kriging (Cressie, "Statistics for
/// Spatial Data", 1993, section 3.4), which for points in use are those of Baarda's data snooping ("A testing
/// procedure for use in geodetic networks", 1968) by blocks of three.
///
/// Fails, with the reason: fewer than three control points; points on one line, or so near one that a
/// rotation is known worse than `kWorstControlRotation`; no three points that agree (and whether they would
/// with x and y exchanged); two groups of which either may be the right one. Throws ContractViolation when
/// lengths differ.
[[nodiscard]] Result<ControlFit> fit_control(const ControlPairs& pairs);

}  // namespace adit

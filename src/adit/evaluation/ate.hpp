// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Absolute trajectory error: how far each estimated position is from the true one after a rigid alignment.
#pragma once

#include <span>
#include <vector>

#include "adit/core/records.hpp"

namespace adit {

/// Errors of the positions of one trajectory, metres.
struct AteResult {
  std::vector<Stamp> stamps;       ///< Of the poses that have a truth.
  std::vector<double> errors_m;    ///< Distance between estimated and true position, one per stamp.
  std::vector<Vector3> positions;  ///< The aligned estimate, in the world frame of the truth, one per stamp.
  Pose T_world_estimate;           ///< The alignment used.
  double max_m = 0.0;              ///< The largest error.
  double rmse_m = 0.0;             ///< The root of their mean square.
  double mean_m = 0.0;             ///< Their mean.
  double median_m = 0.0;           ///< Their median.
  std::size_t num_unmatched = 0;   ///< Estimated poses for which there was no truth.
};

/// ATE of one trajectory after its own SE(3) alignment (Umeyama, no scale). Fails as `associate` does.
[[nodiscard]] Result<AteResult> ate(const Trajectory& estimate, const Trajectory& truth);

/// The drift of odometry alone, metres: the largest distance of any position from the true one when the pose
/// is right at the start, in the middle, or at the end, whichever is worst. Fails as `associate` does.
[[nodiscard]] Result<double> largest_drift_m(const Trajectory& estimate, const Trajectory& truth);

/// ATE of several robots whose estimates share one frame, after ONE SE(3) alignment of all poses together, so
/// that a map that was merged wrongly shows. The results are in the order of the robots. Fails when a robot
/// has no pose with a truth; the message says which. Throws ContractViolation when the spans differ in
/// length.
[[nodiscard]] Result<std::vector<AteResult>> joint_ate(std::span<const Trajectory> estimates,
                                                       std::span<const Trajectory> truths);

}  // namespace adit

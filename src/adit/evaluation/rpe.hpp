// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Relative pose error: how much a trajectory drifts over a stretch of given length, whatever its frame.
#pragma once

#include <vector>

#include "adit/core/records.hpp"

namespace adit {

/// One entry per segment. Per cent and degrees per metre follow by dividing by the segment's length.
struct RpeResult {
  std::vector<double> translation_errors_m;  ///< Size of the translation of each error.
  std::vector<double> rotation_errors_rad;   ///< Its angle.
  double segment_m = 0.0;                    ///< Length of the segments along the true path.
  double translation_rmse_m = 0.0;           ///< Root of the mean square of the translations.
  double translation_median_m = 0.0;         ///< Their median.
  double rotation_rmse_rad = 0.0;            ///< Root of the mean square of the angles.
  double rotation_median_rad = 0.0;          ///< Their median.
};

/// For each pose i, j is the first pose that lies `segment_m` further along the TRUE path; the error of the
/// segment is (truth_i^-1 truth_j)^-1 (estimate_i^-1 estimate_j). Fails as `associate` does, and when the
/// path is shorter than one segment. Source: Sturm et al., "A benchmark for the evaluation of RGB-D SLAM
/// systems", IROS 2012, with segments by distance as in Geiger et al., "Are we ready for autonomous
/// driving?", CVPR 2012. `segment_m` > 0.
[[nodiscard]] Result<RpeResult> rpe(const Trajectory& estimate, const Trajectory& truth,
                                    double segment_m = 10.0);

}  // namespace adit

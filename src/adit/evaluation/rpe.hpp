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

/// For each pose i, j is the later pose whose distance from i along the TRUE path is nearest to `segment_m`,
/// the first of several; the error of the segment is (truth_i^-1 truth_j)^-1 (estimate_i^-1 estimate_j).
/// Segments that are off by more than `tolerance`, a share of `segment_m`, are left out. This is what evo
/// gives of poses with equal stamps: evo_rpe tum TRUTH ESTIMATE --delta SEGMENT --delta_unit m --all_pairs
/// --pairs_from_reference --delta_tol TOLERANCE (its default is 0.1, too). Fails as `associate` does, and
/// where no segment is left, as of a path that is shorter than one. Source: Sturm et al., "A benchmark for
/// the evaluation of RGB-D SLAM systems", IROS 2012, with segments by distance as in Geiger et al., "Are we
/// ready for autonomous driving?", CVPR 2012. `segment_m` > 0, `tolerance` >= 0.
[[nodiscard]] Result<RpeResult> rpe(const Trajectory& estimate, const Trajectory& truth,
                                    double segment_m = 10.0, double tolerance = 0.1);

}  // namespace adit

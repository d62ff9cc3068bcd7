// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/rpe.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/evaluation/associate.hpp"
#include "adit/evaluation/statistics.hpp"

namespace adit {
namespace {

/// Metres driven until each pose, along the polyline.
std::vector<double> distances_driven(const std::vector<Pose>& poses) {
  std::vector<double> driven(poses.size(), 0.0);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    driven[i] = driven[i - 1] + (poses[i].translation() - poses[i - 1].translation()).norm();
  }
  return driven;
}

/// Of the poses after i the one whose distance from i is nearest to `segment_m`, the first of several.
/// `beyond`: the first one that lies as far as that, or their number.
std::size_t end_of_segment(const std::vector<double>& driven, std::size_t i, std::size_t beyond,
                           double segment_m) {
  const auto off = [&](std::size_t j) { return std::abs(driven[j] - driven[i] - segment_m); };
  std::size_t j = std::min(beyond, driven.size() - 1);
  while (j > i + 1 && off(j - 1) <= off(j)) --j;
  return j;
}

}  // namespace

Result<RpeResult> rpe(const Trajectory& estimate, const Trajectory& truth, double segment_m,
                      double tolerance) {
  ADIT_CHECK(segment_m > 0.0, "a segment has a length");
  ADIT_CHECK(tolerance >= 0.0, "a tolerance is a share of the segment");
  const Result<AssociatedPoses> pairs = associate(estimate, truth);
  if (!pairs) return tl::unexpected(pairs.error());
  const std::vector<double> driven = distances_driven(pairs->truth);
  RpeResult result;
  result.segment_m = segment_m;
  for (std::size_t i = 0, beyond = 0; i + 1 < pairs->size(); ++i) {
    while (beyond < pairs->size() && driven[beyond] - driven[i] < segment_m) ++beyond;
    const std::size_t j = end_of_segment(driven, i, beyond, segment_m);
    if (std::abs(driven[j] - driven[i] - segment_m) > tolerance * segment_m) continue;
    const Pose true_step = pairs->truth[i].inverse() * pairs->truth[j];
    const Pose error = true_step.inverse() * (pairs->estimate[i].inverse() * pairs->estimate[j]);
    result.translation_errors_m.push_back(error.translation().norm());
    result.rotation_errors_rad.push_back(error.angle());
  }
  if (result.translation_errors_m.empty() && driven.back() < segment_m) {
    return fail(format("the true path is {:.1f} m long, shorter than one segment of {:.1f} m", driven.back(),
                       segment_m));
  }
  if (result.translation_errors_m.empty()) {
    return fail(format(
        "no two of {} poses lie {:.1f} m apart along the true path, to {:.1f} m; give a longer segment",
        pairs->size(), segment_m, tolerance * segment_m));
  }
  result.translation_rmse_m = root_mean_square(result.translation_errors_m);
  result.translation_median_m = median(result.translation_errors_m);
  result.rotation_rmse_rad = root_mean_square(result.rotation_errors_rad);
  result.rotation_median_rad = median(result.rotation_errors_rad);
  return result;
}

}  // namespace adit

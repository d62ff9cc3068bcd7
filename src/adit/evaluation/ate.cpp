// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/ate.hpp"

#include <algorithm>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/evaluation/associate.hpp"
#include "adit/evaluation/statistics.hpp"
#include "adit/geometry/umeyama.hpp"

namespace adit {
namespace {

AteResult errors_after(const Pose& T_world_estimate, const AssociatedPoses& pairs) {
  AteResult result;
  result.stamps = pairs.stamps;
  result.T_world_estimate = T_world_estimate;
  result.num_unmatched = pairs.num_unmatched;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    result.positions.push_back(T_world_estimate * pairs.estimate[i].translation());
    result.errors_m.push_back((result.positions[i] - pairs.truth[i].translation()).norm());
  }
  result.max_m = *std::max_element(result.errors_m.begin(), result.errors_m.end());
  result.rmse_m = root_mean_square(result.errors_m);
  result.mean_m = mean(result.errors_m);
  result.median_m = median(result.errors_m);
  return result;
}

}  // namespace

Result<std::vector<AteResult>> joint_ate(std::span<const Trajectory> estimates,
                                         std::span<const Trajectory> truths) {
  ADIT_CHECK(estimates.size() == truths.size(), "every estimate needs its truth");
  std::vector<AssociatedPoses> robots;
  std::vector<Vector3> source;
  std::vector<Vector3> target;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const Result<AssociatedPoses> pairs = associate(estimates[i], truths[i]);
    if (!pairs) return fail(format("trajectory {} of {}", i + 1, estimates.size()), pairs.error());
    for (const Pose& pose : pairs->estimate) source.push_back(pose.translation());
    for (const Pose& pose : pairs->truth) target.push_back(pose.translation());
    robots.push_back(*pairs);
  }
  const Result<Pose> T_world_estimate = align_rigid(source, target);
  if (!T_world_estimate) return tl::unexpected(T_world_estimate.error());
  std::vector<AteResult> results;
  for (const AssociatedPoses& pairs : robots) results.push_back(errors_after(*T_world_estimate, pairs));
  return results;
}

Result<AteResult> ate(const Trajectory& estimate, const Trajectory& truth) {
  return joint_ate({&estimate, 1}, {&truth, 1}).map([](const std::vector<AteResult>& results) {
    return results.front();
  });
}

Result<double> largest_drift_m(const Trajectory& estimate, const Trajectory& truth) {
  return associate(estimate, truth).map([](const AssociatedPoses& pairs) {
    double largest = 0.0;
    for (const std::size_t anchor : {std::size_t{0}, pairs.size() / 2, pairs.size() - 1}) {
      const Pose T_world_estimate = pairs.truth[anchor] * pairs.estimate[anchor].inverse();
      for (std::size_t i = 0; i < pairs.size(); ++i)
        largest = std::max(
            largest,
            (T_world_estimate * pairs.estimate[i].translation() - pairs.truth[i].translation()).norm());
    }
    return largest;
  });
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/associate.hpp"

#include <algorithm>

#include "adit/core/format.hpp"

namespace adit {
namespace {

std::string span_text(const Trajectory& trajectory) {
  if (trajectory.empty()) return "empty";
  return format("{:.3f} to {:.3f} s", trajectory.front().stamp.seconds(), trajectory.back().stamp.seconds());
}

/// Whether the two true poses around `stamp` are close enough in time to interpolate between them.
bool covered(const Trajectory& truth, Stamp stamp, Duration max_gap) {
  const auto after = std::lower_bound(truth.begin(), truth.end(), stamp,
                                      [](const StampedPose& p, Stamp s) { return p.stamp < s; });
  if (after == truth.end()) return false;
  if (after->stamp == stamp) return true;
  return after != truth.begin() && after->stamp - (after - 1)->stamp <= max_gap;
}

}  // namespace

Result<AssociatedPoses> associate(const Trajectory& estimate, const Trajectory& truth, Duration max_gap) {
  AssociatedPoses pairs;
  for (const StampedPose& pose : estimate) {
    if (!covered(truth, pose.stamp, max_gap)) {
      ++pairs.num_unmatched;
      continue;
    }
    const Result<Pose> T_world_body = pose_at(truth, pose.stamp);
    if (!T_world_body) return tl::unexpected(T_world_body.error());
    pairs.stamps.push_back(pose.stamp);
    pairs.estimate.push_back(pose.T_world_body);
    pairs.truth.push_back(*T_world_body);
  }
  if (pairs.size() == 0) {
    return fail(
        format("no estimated pose has a ground truth: the estimate spans {}, the truth {}; "
               "give both stamps of one clock",
               span_text(estimate), span_text(truth)));
  }
  return pairs;
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/shared_stretch.hpp"

#include <algorithm>

#include "adit/core/check.hpp"

namespace adit {
namespace {

/// Metres between the points that stand for a path: small against the reach, coarse enough for brute force.
constexpr double kStep = 0.5;

/// Points every `kStep` along the path, whatever the robot's speed.
std::vector<Vector3> points_along(const Trajectory& truth) {
  std::vector<Vector3> points;
  double since_last = kStep;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Vector3& here = truth[i].T_world_body.translation();
    if (i > 0) since_last += (here - truth[i - 1].T_world_body.translation()).norm();
    if (since_last < kStep) continue;
    points.push_back(here);
    since_last = 0.0;
  }
  return points;
}

/// Metres of path `a` near path `b`.
double covered_m(const std::vector<Vector3>& a, const std::vector<Vector3>& b, double reach_m) {
  double covered = 0.0;
  for (std::size_t i = 1; i < a.size(); ++i) {
    const bool near = std::ranges::any_of(
        b, [&](const Vector3& p) { return (p - a[i]).squaredNorm() < reach_m * reach_m; });
    if (near) covered += (a[i] - a[i - 1]).norm();
  }
  return covered;
}

}  // namespace

double shared_stretch_m(const Trajectory& truth_a, const Trajectory& truth_b, double reach_m) {
  const std::vector<Vector3> a = points_along(truth_a);
  const std::vector<Vector3> b = points_along(truth_b);
  return std::min(covered_m(a, b, reach_m), covered_m(b, a, reach_m));
}

std::vector<std::vector<std::size_t>> groups_sharing(const std::vector<std::vector<double>>& shared_m,
                                                     double min_shared_m) {
  std::vector<std::vector<std::size_t>> groups;
  std::vector<bool> placed(shared_m.size(), false);
  for (std::size_t first = 0; first < shared_m.size(); ++first) {
    ADIT_CHECK(shared_m[first].size() == shared_m.size(), "one row and one column per robot");
    if (placed[first]) continue;
    std::vector<std::size_t> group{first};
    placed[first] = true;
    for (std::size_t k = 0; k < group.size(); ++k)  // Grows while it is walked through.
      for (std::size_t other = 0; other < shared_m.size(); ++other)
        if (!placed[other] && shared_m[group[k]][other] >= min_shared_m) {
          placed[other] = true;
          group.push_back(other);
        }
    std::ranges::sort(group);
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace adit

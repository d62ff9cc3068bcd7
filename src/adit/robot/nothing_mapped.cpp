// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/nothing_mapped.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "adit/core/angles.hpp"
#include "adit/core/format.hpp"

namespace adit {
namespace {

/// What nineteen of twenty points of a scan lie within, as the sensor sees it.
struct View {
  std::size_t num_points = 0;
  double nearest_m = 0.0;
  double farthest_m = 0.0;
  double width_deg = 0.0;  ///< Of the cone around the mean direction.
};

View view_of(const PointCloud& cloud) {
  constexpr double kNearlyAll = 0.95;
  std::vector<double> ranges;
  Vector3 mean = Vector3::Zero();
  for (const Eigen::Vector3f& p : cloud.points) {
    const double range = p.cast<double>().norm();
    if (!(range > 0.0)) continue;
    ranges.push_back(range);
    mean += p.cast<double>() / range;
  }
  View view{ranges.size()};
  if (ranges.empty()) return view;
  mean.normalize();
  std::vector<double> angles;
  for (const Eigen::Vector3f& p : cloud.points) {
    const double range = p.cast<double>().norm();
    if (range > 0.0) angles.push_back(std::acos(std::clamp(mean.dot(p.cast<double>()) / range, -1.0, 1.0)));
  }
  const auto last = static_cast<std::ptrdiff_t>(kNearlyAll * static_cast<double>(ranges.size() - 1));
  std::ranges::nth_element(angles, angles.begin() + last);
  std::ranges::sort(ranges);
  view.width_deg = 2.0 * angles[static_cast<std::size_t>(last)] / kDegree;
  view.nearest_m = ranges.front();
  view.farthest_m = ranges[static_cast<std::size_t>(last)];
  return view;
}

}  // namespace

bool is_nothing_mapped(const std::map<StepStatus, int>& counts) {
  return std::ranges::all_of(counts, [](const auto& count) {
    return count.first == StepStatus::too_few_points || count.first == StepStatus::no_map;
  });
}

std::string why_nothing_mapped(const Recording& recording) {
  constexpr double kNarrow = 130.0;     // degrees, wider than depth cameras see and narrower than LiDARs
  constexpr std::size_t kEnough = 500;  // points, to tell what sensor they are of
  const std::string all =
      format("{}: none of {} scans could be mapped", recording.name, recording.num_scans());
  if (recording.num_scans() < 2) return all + ": there have to be two or more, to see the robot move";
  const Result<Scan> first = recording.read_scan(0);
  if (!first) return format("{}: {}", all, first.error().message);
  const View view = view_of(first->cloud);
  const std::string seen = format("{}: the first has {} points, {:.1f} to {:.1f} m away", all,
                                  view.num_points, view.nearest_m, view.farthest_m);
  if (view.num_points >= kEnough && view.width_deg < kNarrow)
    return format(
        "{}, within a view of {:.0f} degrees, like a depth camera's; adit maps with LiDARs that see the "
        "walls around them",
        seen, view.width_deg);
  return seen + "; too few points lie within the ranges that odometry uses, or on what was seen before";
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/records.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/angles.hpp"
#include "adit/core/format.hpp"

namespace adit {

Result<Pose> pose_at(const Trajectory& trajectory, Stamp stamp) {
  if (trajectory.empty()) return fail("the trajectory is empty");
  if (stamp < trajectory.front().stamp || stamp > trajectory.back().stamp) {
    return fail(format("no pose at {:.6f} s: the trajectory spans {:.6f} to {:.6f} s", stamp.seconds(),
                       trajectory.front().stamp.seconds(), trajectory.back().stamp.seconds()));
  }
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), stamp,
                                      [](const StampedPose& p, Stamp s) { return p.stamp < s; });
  if (after->stamp == stamp) return after->T_world_body;
  const auto before = after - 1;
  const double s = to_seconds(stamp - before->stamp) / to_seconds(after->stamp - before->stamp);
  return interpolate(before->T_world_body, after->T_world_body, s);
}

double path_length(const Trajectory& trajectory) {
  double length = 0.0;
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    length +=
        (trajectory[i].T_world_body.translation() - trajectory[i - 1].T_world_body.translation()).norm();
  }
  return length;
}

Result<WheelDelta> wheel_delta(const Trajectory& wheel, Stamp from, Stamp to) {
  const Result<Pose> T_odom_0 = pose_at(wheel, from);
  if (!T_odom_0) return fail("wheel odometry", T_odom_0.error());
  const Result<Pose> T_odom_1 = pose_at(wheel, to);
  if (!T_odom_1) return fail("wheel odometry", T_odom_1.error());
  WheelDelta delta;
  delta.duration = to - from;
  delta.T_base0_base1 = T_odom_0->inverse() * *T_odom_1;
  const double distance = delta.T_base0_base1.translation().norm();
  const double along = std::max(0.001, 0.02 * distance);
  const double across = std::max(0.001, 0.01 * distance);
  const double turn = std::max(0.02 * kDegree, 0.5 * kDegree * distance + 0.02 * delta.T_base0_base1.angle());
  Vector6 sigma;
  sigma << along, across, across, turn, turn, turn;
  delta.covariance = sigma.cwiseAbs2().asDiagonal();
  return delta;
}

std::vector<ImuSample> imu_between(const std::vector<ImuSample>& imu, Stamp begin, Stamp end,
                                   Duration longest_gap) {
  if (imu.empty() || begin < imu.front().stamp || end > imu.back().stamp) return {};
  const auto first = std::ranges::upper_bound(imu, begin, {}, &ImuSample::stamp) - 1;
  const auto last = std::lower_bound(first, imu.end(), end,
                                     [](const ImuSample& sample, Stamp s) { return sample.stamp < s; });
  const auto is_gap = [&](const ImuSample& a, const ImuSample& b) { return b.stamp - a.stamp > longest_gap; };
  if (std::adjacent_find(first, last + 1, is_gap) != last + 1) return {};
  return {first, last + 1};
}

std::string_view to_string(StepStatus status) {
  switch (status) {
    case StepStatus::ok:
      return "ok";
    case StepStatus::no_map:
      return "no_map";
    case StepStatus::too_few_points:
      return "too_few_points";
    case StepStatus::degenerate:
      return "degenerate";
    case StepStatus::diverged:
      return "diverged";
  }
  return "unknown";
}

std::string_view to_string(LoopVerdict verdict) {
  return verdict == LoopVerdict::accepted ? "accepted" : "rejected";
}

LoopClosure reversed(LoopClosure loop) {
  std::swap(loop.from, loop.to);
  // T exp(d) inverted is exp(-d) T^-1 = T^-1 exp(-Ad(T) d), so the new perturbation is -Ad(T) d.
  const Matrix6 ad_inverse = loop.T_from_to.inverse().adjoint();
  loop.information = ad_inverse.transpose() * loop.information * ad_inverse;
  loop.T_from_to = loop.T_from_to.inverse();
  return loop;
}

}  // namespace adit

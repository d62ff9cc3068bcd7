// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/mount_by_motion.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "adit/core/angles.hpp"
#include "adit/core/decompositions.hpp"
#include "adit/core/parallel.hpp"
#include "adit/robot/scan_motion.hpp"

namespace adit {
namespace {

/// By how much more the scans have the robot move, ahead and to the left, than the wheels do, which say how
/// far it went `ahead`; the scans say how much it has `turned`. Where the mount has to be turned by `yaw` and
/// shifted by `shift`, and wheels count (1 + scale) of the way and `slip` of a turn to either side too much:
/// along = -scale * ahead - shift.y * turned - slip * |turned| and left = -yaw * ahead + shift.x * turned.
struct StepBeyondWheels {
  double ahead, turned, left;
  std::optional<double> along;  ///< Where scans say how far.
};

std::vector<StepBeyondWheels> steps_beyond_wheels(const Recording& recording,
                                                  std::span<const std::size_t> scans) {
  constexpr double kUnknown = 10.0;      // metres and radians, along directions that the scan leaves open
  constexpr double kSideSigma = 0.005;   // metres
  constexpr double kAlongSigma = 0.02;   // metres; few scans of a tunnel say it better
  constexpr double kTurnSigma = 0.0005;  // radians
  const ScanMotion motion = motion_of_scans(recording, scans);
  std::vector<StepBeyondWheels> out;
  for (std::size_t k = kSettlingScans; k < motion.steps.size(); ++k) {
    const OdometryStep& before = motion.steps[k - 1];
    const OdometryStep& after = motion.steps[k];
    if (after.status != StepStatus::ok && after.status != StepStatus::degenerate) continue;
    const Matrix6 covariance =
        inverse(Matrix6(after.information + Matrix6::Identity() / (kUnknown * kUnknown)));
    if (std::sqrt(covariance(1, 1)) > kSideSigma || std::sqrt(covariance(5, 5)) > kTurnSigma) continue;
    const Result<Pose> begin = pose_at(recording.wheel, before.stamp);
    const Result<Pose> end = pose_at(recording.wheel, after.stamp);
    if (!begin || !end) continue;
    const Pose by_scans = before.T_odom_base.inverse() * after.T_odom_base;
    const Vector3 by_wheels = (begin->inverse() * *end).translation();
    const Vector3 beyond = by_scans.translation() - by_wheels;
    out.push_back({by_wheels.x(), by_scans.yaw(), beyond.y(), {}});
    if (std::sqrt(covariance(0, 0)) < kAlongSigma) out.back().along = beyond.x();
  }
  return out;
}

/// A shift by its share of turns, and what goes with the way instead, with their standard deviations.
struct ShiftByTurns {
  double by_way, by_way_sigma;
  double shift, shift_sigma;  ///< Metres; the latter infinite where there are too few turns.
};

/// Least squares of beyond = J [by_way, shift, ...], the standard deviations from the residuals.
std::optional<ShiftByTurns> shift_by_turns(const Eigen::MatrixXd& J, const Eigen::VectorXd& beyond) {
  constexpr Eigen::Index kFew = 40;
  if (J.rows() < kFew) return {};
  Eigen::MatrixXd H = J.transpose() * J;
  const double squared_turns = H(1, 1);
  if (!(H(0, 0) > 1.0)) return {};   // hardly moved: some 10 steps of 0.3 m
  constexpr double kFarthest = 1.0;  // metres, or metres a radian, that are possible
  constexpr double kNoise = 0.01;    // metres beyond, a step; only to weigh the prior of what goes with turns
  H.diagonal().tail(H.rows() - 1).array() += kNoise * kNoise / (kFarthest * kFarthest);
  const Eigen::MatrixXd inverse_H = H.inverse();
  const Eigen::VectorXd x = inverse_H * (J.transpose() * beyond);
  const double variance = (beyond - J * x).squaredNorm() / static_cast<double>(J.rows() - J.cols());
  constexpr double kEnoughTurns = 0.01;  // rad^2: some 10 steps of 2 degrees
  return ShiftByTurns{x[0], std::sqrt(variance * inverse_H(0, 0)), x[1],
                      squared_turns > kEnoughTurns ? std::sqrt(variance * inverse_H(1, 1))
                                                   : std::numeric_limits<double>::infinity()};
}

std::optional<ShiftByTurns> shift_ahead(const std::vector<StepBeyondWheels>& steps) {
  Eigen::MatrixXd J(steps.size(), 2);
  Eigen::VectorXd beyond(steps.size());
  for (Eigen::Index i = 0; i < J.rows(); ++i) {
    const StepBeyondWheels& step = steps[static_cast<std::size_t>(i)];
    J.row(i) << -step.ahead, step.turned;
    beyond[i] = step.left;
  }
  return shift_by_turns(J, beyond);
}

/// Apart from slip only where the robot turned to both sides; its standard deviation says so.
std::optional<ShiftByTurns> shift_to_the_left(std::vector<StepBeyondWheels> steps) {
  std::erase_if(steps, [](const StepBeyondWheels& step) { return !step.along; });
  Eigen::MatrixXd J(steps.size(), 3);
  Eigen::VectorXd beyond(steps.size());
  for (Eigen::Index i = 0; i < J.rows(); ++i) {
    const StepBeyondWheels& step = steps[static_cast<std::size_t>(i)];
    J.row(i) << -step.ahead, -step.turned, -std::abs(step.turned);
    beyond[i] = *step.along;
  }
  return shift_by_turns(J, beyond);
}

std::optional<MountByMotion> mount_from(const std::vector<StepBeyondWheels>& steps) {
  const std::optional<ShiftByTurns> ahead = shift_ahead(steps);
  if (!ahead) return {};
  MountByMotion out;
  out.num_steps = steps.size();
  out.yaw_deg = ahead->by_way / kDegree;
  out.yaw_sigma_deg = ahead->by_way_sigma / kDegree;
  out.ahead_m = ahead->shift;
  out.ahead_sigma_m = ahead->shift_sigma;
  if (const std::optional<ShiftByTurns> left = shift_to_the_left(steps)) {
    out.left_m = left->shift;
    out.left_sigma_m = left->shift_sigma;
  }
  return out;
}

/// Of the stretches of `length` scans the `num` in which the wheels turn most: their first scans.
std::vector<std::size_t> where_it_turns(const Recording& recording, const std::vector<std::size_t>& scans,
                                        std::size_t length, std::size_t num) {
  std::vector<std::pair<double, std::size_t>> stretches;
  for (std::size_t begin = 0; begin + length < scans.size(); begin += length) {
    double turned = 0.0;
    for (std::size_t i = begin + 1; i <= begin + length; ++i) {
      const Result<Pose> before = pose_at(recording.wheel, recording.scan_stamps[scans[i - 1]]);
      const Result<Pose> after = pose_at(recording.wheel, recording.scan_stamps[scans[i]]);
      if (before && after) turned += std::abs((before->inverse() * *after).yaw());
    }
    stretches.emplace_back(-turned, begin);
  }
  std::ranges::sort(stretches);
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < std::min(num, stretches.size()); ++i) out.push_back(stretches[i].second);
  return out;
}

}  // namespace

std::optional<MountByMotion> mount_by_motion(const Recording& recording) {
  constexpr std::size_t kStretches =
      6;                               // over the whole drive, and as many where it turns: for the lever arm
  constexpr std::size_t kLength = 25;  // scans
  if (recording.wheel.size() < 2) return {};
  const std::vector<std::size_t> scans = scans_to_check(recording);
  std::vector<std::size_t> starts =
      spread_over(scans.size() > kLength ? scans.size() - kLength : 0, kStretches);
  for (const std::size_t start : where_it_turns(recording, scans, kLength, kStretches))
    if (std::ranges::find(starts, start) == starts.end()) starts.push_back(start);
  std::vector<std::vector<StepBeyondWheels>> of_stretches(starts.size());
  parallel_for_each(starts.size(), [&](std::size_t i) {
    of_stretches[i] = steps_beyond_wheels(recording, std::span(scans).subspan(starts[i], kLength));
  });
  std::vector<StepBeyondWheels> all;
  for (const std::vector<StepBeyondWheels>& one : of_stretches) all.insert(all.end(), one.begin(), one.end());
  return mount_from(all);
}

}  // namespace adit

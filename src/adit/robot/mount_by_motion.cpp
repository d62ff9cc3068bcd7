// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/mount_by_motion.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "adit/core/angles.hpp"
#include "adit/core/decompositions.hpp"
#include "adit/core/format.hpp"
#include "adit/core/parallel.hpp"
#include "adit/robot/scan_motion.hpp"

namespace adit {
namespace {

std::vector<MotionStep> steps_of(const Recording& recording, std::span<const std::size_t> scans) {
  constexpr double kUnknown = 10.0;  // metres and radians, along directions that the scan leaves open
  const ScanMotion motion = motion_of_scans(recording, scans);
  std::vector<MotionStep> out;
  for (std::size_t k = kSettlingScans; k < motion.steps.size(); ++k) {
    const OdometryStep& before = motion.steps[k - 1];
    const OdometryStep& after = motion.steps[k];
    const Result<Pose> begin = pose_at(recording.wheel, before.stamp);
    const Result<Pose> end = pose_at(recording.wheel, after.stamp);
    if (!begin || !end) continue;
    const Pose by_wheels = begin->inverse() * *end;
    out.push_back({by_wheels.translation().head<2>(), by_wheels.yaw(),
                   before.T_odom_base.inverse() * after.T_odom_base,
                   inverse(Matrix6(after.information + Matrix6::Identity() / (kUnknown * kUnknown))),
                   after.status == StepStatus::ok || after.status == StepStatus::degenerate});
  }
  return out;
}

/// A MotionStep on the floor.
struct Step {
  Eigen::Vector2d by_wheels;
  Eigen::Vector2d by_scans;    ///< In the axes that the mount in use gives the base.
  Eigen::Matrix2d covariance;  ///< Of `by_scans`.
  double turned = 0.0;         ///< By the scans.
  bool is_seen = false;        ///< Scans state that they know it, along the tunnel, too.
};

Step on_the_floor(const MotionStep& step) {
  constexpr double kOpenSigma = 0.05;    // metres: a quarter of the way between usual scans
  constexpr double kTurnSigma = 0.0005;  // radians
  Step out{step.by_wheels, step.by_scans.translation().head<2>(), step.covariance.topLeftCorner<2, 2>(),
           step.by_scans.yaw()};
  out.is_seen = step.is_registered && out.covariance.trace() < kOpenSigma * kOpenSigma &&
                std::sqrt(step.covariance(5, 5)) < kTurnSigma;
  return out;
}

constexpr double kFarthest = 1.0;  // metres: a lever arm that is possible

/// Along a smooth tunnel the rings of a scan fit best where those before lay, so that it says with confidence
/// that the robot stood still: it has not seen the motion. How far the robot went does not depend on the yaw
/// of the mount, and only little on its lever arm.
bool goes_as_far(double by_scans, double by_wheels, double turned) {
  constexpr double kAgree = 0.25;  // share of the way: some 5 cm, where scans of a mine err by 2 to 3
  return std::abs(by_scans - by_wheels) < kAgree * by_wheels + kFarthest * std::abs(turned);
}
bool goes_as_far_as_the_wheels(const Step& step) {
  return goes_as_far(step.by_scans.norm(), step.by_wheels.norm(), step.turned);
}

/// By how much all of these have to be turned to go where the wheels went, radians.
double turn_onto_the_wheels(const std::vector<Step>& steps) {
  double sine = 0.0;
  double cosine = 0.0;
  for (const auto& [by_wheels, by_scans, covariance, turned, is_seen] : steps) {
    sine += by_scans.x() * by_wheels.y() - by_scans.y() * by_wheels.x();
    cosine += by_scans.dot(by_wheels);
  }
  return std::atan2(sine, cosine);
}

/// By how much more the scans have the robot move, ahead and to the left, than the wheels do, which say how
/// far it went `ahead`; the scans say how much it has `turned`. Where the mount has to be turned by `yaw` and
/// shifted by `shift`, and wheels count (1 + scale) of the way and `slip` of a turn to either side too much:
/// along = -scale * ahead - shift.y * turned - slip * |turned| and left = -yaw * ahead + shift.x * turned.
struct StepBeyondWheels {
  double ahead, turned, left;
  std::optional<double> along;  ///< Where scans say how far.
};

/// After the scans' motion was turned by `yaw`, as those equations hold for small angles alone.
std::vector<StepBeyondWheels> beyond_wheels(const std::vector<Step>& steps, double yaw) {
  constexpr double kSideSigma = 0.005;  // metres
  constexpr double kAlongSigma = 0.02;  // metres; few scans of a tunnel say it better
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(yaw).toRotationMatrix();
  std::vector<StepBeyondWheels> out;
  for (const Step& step : steps) {
    const Eigen::Matrix2d covariance = R * step.covariance * R.transpose();
    if (std::sqrt(covariance(1, 1)) > kSideSigma) continue;
    const Eigen::Vector2d beyond = R * step.by_scans - step.by_wheels;
    out.push_back({step.by_wheels.x(), step.turned, beyond.y(), {}});
    if (std::sqrt(covariance(0, 0)) < kAlongSigma) out.back().along = beyond.x();
  }
  return out;
}

constexpr double kLeastMotion = 1.0;  // m^2, of all steps: 25 of 0.2 m
constexpr std::size_t kFewSteps = 40;

/// A shift by its share of turns, and what goes with the way instead, with their standard deviations.
struct ShiftByTurns {
  double by_way, by_way_sigma;
  double shift, shift_sigma;  ///< Metres; the latter infinite where there are too few turns.
};

/// Least squares of beyond = J [by_way, shift, ...], the standard deviations from the residuals.
std::optional<ShiftByTurns> shift_by_turns(const Eigen::MatrixXd& J, const Eigen::VectorXd& beyond) {
  if (J.rows() < static_cast<Eigen::Index>(kFewSteps)) return {};
  Eigen::MatrixXd H = J.transpose() * J;
  const double squared_turns = H(1, 1);
  if (H(0, 0) < kLeastMotion) return {};
  constexpr double kNoise = 0.01;  // metres beyond, a step; only to weigh the prior of what goes with turns
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

Result<MountByMotion> mount_from(const std::vector<Step>& all) {
  double moved = 0.0;
  for (const Step& step : all) moved += step.by_wheels.squaredNorm();
  if (moved < kLeastMotion)
    return fail(
        format("by the wheels the robot moves too little in the {} steps from scan to scan", all.size()));
  std::vector<Step> seen;
  std::ranges::copy_if(all, std::back_inserter(seen),
                       [](const Step& step) { return step.is_seen && goes_as_far_as_the_wheels(step); });
  const double coarse = turn_onto_the_wheels(seen);
  const std::vector<StepBeyondWheels> steps = beyond_wheels(seen, coarse);
  const std::optional<ShiftByTurns> ahead = shift_ahead(steps);
  if (!ahead)
    return fail(
        format("cannot be told: the scans leave motion along the tunnel open ({} of {} steps from scan to "
               "scan go as far as by the wheels)",
               steps.size(), all.size()));
  MountByMotion out;
  out.num_steps = steps.size();
  out.yaw_deg = std::remainder(coarse + ahead->by_way, 2.0 * std::numbers::pi) / kDegree;
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

/// Whether scans have the robot go as far as the wheels do, in whatever direction.
bool goes_as_far_in_space(const MotionStep& step) {
  return step.is_registered &&
         goes_as_far(step.by_scans.translation().norm(), step.by_wheels.norm(), step.by_scans.angle());
}

/// Where the robot drives ahead, in the axes of the mount; none where steps do not agree.
std::optional<Vector3> direction_ahead(const std::vector<MotionStep>& known) {
  constexpr double kLeast = 0.02;    // metres a step
  constexpr double kAgreeing = 0.9;  // of the length of all steps, laid end to end: within some 25 degrees
  Vector3 sum = Vector3::Zero();
  double length = 0.0;
  std::size_t num = 0;
  for (const MotionStep& step : known) {
    if (std::abs(step.by_wheels.x()) < kLeast) continue;
    // The sensor's own way in turns is not along x.
    if (std::abs(step.turned_by_wheels) > 0.1 * std::abs(step.by_wheels.x())) continue;
    sum += step.by_wheels.x() > 0.0 ? step.by_scans.translation() : -step.by_scans.translation();
    length += step.by_scans.translation().norm();
    ++num;
  }
  if (num < kFewSteps || sum.norm() < kAgreeing * length) return {};
  return sum.normalized();
}

/// The axis about which the robot turns anticlockwise: by how much it turns by the scans where it turns by
/// one radian by the wheels, least squares of all steps. None where it turns too little against the roll and
/// pitch of the way, or by another angle than wheels that slip in turns would say.
std::optional<Vector3> axis_of_turns(const std::vector<MotionStep>& steps) {
  constexpr double kSigma = 0.15;  // of the axis, a share of its length: 9 degrees
  constexpr double kLeast = 0.4;   // radians a radian
  constexpr double kMost = 2.5;
  Vector3 sum = Vector3::Zero();
  double by_wheels = 0.0;
  for (const MotionStep& step : steps) {
    sum += step.turned_by_wheels * so3::log(step.by_scans.rotation());
    by_wheels += step.turned_by_wheels * step.turned_by_wheels;
  }
  if (by_wheels == 0.0) return {};
  const Vector3 axis = sum / by_wheels;
  double squares = 0.0;
  for (const MotionStep& step : steps)
    squares += (so3::log(step.by_scans.rotation()) - step.turned_by_wheels * axis).squaredNorm();
  const double sigma = std::sqrt(squares / (3.0 * static_cast<double>(steps.size())) / by_wheels);
  if (axis.norm() < kLeast || axis.norm() > kMost || sigma > kSigma * axis.norm()) return {};
  return axis.normalized();
}

}  // namespace

Result<std::vector<MotionStep>> motion_steps(const Recording& recording) {
  constexpr std::size_t kStretches =
      6;                               // over the whole drive, and as many where it turns: for the lever arm
  constexpr std::size_t kLength = 25;  // scans
  if (recording.wheel.size() < 2) return fail("there are no wheels to compare with");
  const std::vector<std::size_t> scans = scans_to_check(recording);
  std::vector<std::size_t> starts =
      spread_over(scans.size() > kLength ? scans.size() - kLength : 0, kStretches);
  for (const std::size_t start : where_it_turns(recording, scans, kLength, kStretches))
    if (std::ranges::find(starts, start) == starts.end()) starts.push_back(start);
  std::vector<std::vector<MotionStep>> of_stretches(starts.size());
  parallel_for_each(starts.size(), [&](std::size_t i) {
    of_stretches[i] = steps_of(recording, std::span(scans).subspan(starts[i], kLength));
  });
  std::vector<MotionStep> all;
  for (const std::vector<MotionStep>& one : of_stretches) all.insert(all.end(), one.begin(), one.end());
  if (all.empty()) return fail("too few scans follow one another while the wheels measure");
  return all;
}

std::optional<TiltByMotion> tilt_by_motion(const std::vector<MotionStep>& steps) {
  constexpr double kLeastDeg = 30.0;
  constexpr double kUpright = 0.3;  // part of a direction that has to be left for it to point somewhere
  std::vector<MotionStep> known;
  std::ranges::copy_if(steps, std::back_inserter(known), goes_as_far_in_space);
  const std::optional<Vector3> ahead = direction_ahead(known);
  if (!ahead) return {};
  const Vector3 level(ahead->x(), ahead->y(), 0.0);
  const Vector3 along = level.norm() < kUpright ? Vector3(Vector3::UnitX()) : Vector3(level.normalized());
  Eigen::Quaterniond turn = Eigen::Quaterniond::FromTwoVectors(*ahead, along);
  if (const std::optional<Vector3> axis = axis_of_turns(known)) {
    // About the direction ahead, and as wheels may be wired left for right, no further than it lies down.
    const Vector3 turned = turn * *axis;
    const Vector3 up = turned - turned.dot(along) * along;
    const double roll = std::atan2(up.cross(Vector3::UnitZ()).dot(along), up.z());
    if (up.norm() > kUpright && std::abs(roll) > kLeastDeg * kDegree &&
        std::abs(roll) < std::numbers::pi - kLeastDeg * kDegree)
      turn = Eigen::Quaterniond(Eigen::AngleAxisd(roll, along)) * turn;
  }
  TiltByMotion tilt{turn.toRotationMatrix(), 0.0, known.size()};
  tilt.tilt_deg = std::acos(std::clamp(tilt.R_level_base(2, 2), -1.0, 1.0)) / kDegree;
  return tilt.tilt_deg < kLeastDeg ? std::nullopt : std::optional(tilt);
}

Result<MountByMotion> mount_by_motion(const std::vector<MotionStep>& steps) {
  std::vector<Step> on_floor;
  std::ranges::transform(steps, std::back_inserter(on_floor), on_the_floor);
  return mount_from(on_floor);
}

}  // namespace adit

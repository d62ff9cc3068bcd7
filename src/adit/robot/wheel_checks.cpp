// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <optional>

#include "adit/core/format.hpp"
#include "adit/robot/sensor_checks.hpp"
#include "adit/robot/wheel_comparison.hpp"
#include "adit/robot/wheel_covariance.hpp"

namespace adit {
namespace {

SensorFinding on_wheels(Finding finding, Consequence consequence, const std::string& sentence) {
  return {finding, consequence, "wheels: " + sentence};
}

std::string at_second(Stamp stamp) { return format("{:.2f} s", stamp.seconds()); }

bool is_same(const Pose& a, const Pose& b) {
  return a.translation() == b.translation() && a.rotation().coeffs() == b.rotation().coeffs();
}

double interval(const Trajectory& wheel, std::size_t i) {
  return to_seconds(wheel[i].stamp - wheel[i - 1].stamp);
}
Pose motion(const Trajectory& wheel, std::size_t i) {
  return wheel[i - 1].T_world_body.inverse() * wheel[i].T_world_body;
}
double usual_interval(const Trajectory& wheel) {
  if (wheel.size() < 2) return 0.0;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < wheel.size(); ++i) intervals.push_back(interval(wheel, i));
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::ranges::nth_element(intervals, middle);
  return *middle;
}
// Messages that were stamped as they arrived, two at a time, are no sign of speed: each took the usual time.
double speed(const Trajectory& wheel, std::size_t i, double usual) {
  return motion(wheel, i).translation().norm() / std::max(interval(wheel, i), usual);
}

// Wheels that drive and then stand from one value to the next, without braking, for a while: their value no
// longer arrives, or they have left the ground. The frozen values are left out.
std::optional<SensorFinding> leave_out_frozen(Trajectory& wheel) {
  constexpr double kDriving = 0.3;   // m/s
  constexpr double kBraking = 10.0;  // m/s^2: tyres hold no more
  constexpr double kWhile = 0.3;     // seconds
  const double usual = usual_interval(wheel);
  Trajectory kept;
  std::vector<Stamp> begins;
  double longest = 0.0;
  for (std::size_t i = 0; i < wheel.size(); ++i) {
    kept.push_back(wheel[i]);
    if (i == 0 || speed(wheel, i, usual) < std::max(kDriving, kBraking * interval(wheel, i))) continue;
    std::size_t last = i;
    while (last + 1 < wheel.size() && is_same(wheel[last + 1].T_world_body, wheel[i].T_world_body)) ++last;
    const double lasting = to_seconds(wheel[last].stamp - wheel[i].stamp);
    if (lasting < kWhile) continue;
    begins.push_back(wheel[i].stamp);
    longest = std::max(longest, lasting);
    i = last;
  }
  if (begins.empty()) return std::nullopt;
  wheel = std::move(kept);
  return on_wheels(
      Finding::wheels_frozen, Consequence::repaired,
      format("their value stops changing at full speed, {} times, first at {}, longest for {:.2f} "
             "s; it is left out there; look for lost messages, a stuck encoder or a lifted robot",
             begins.size(), at_second(begins.front()), longest));
}

// A step that no robot makes is replaced by the one before it.
std::optional<SensorFinding> take_out_jumps(Trajectory& wheel) {
  constexpr double kFast = 5.0;  // m/s
  const double usual_s = usual_interval(wheel);
  std::vector<double> speeds;
  for (std::size_t i = 1; i < wheel.size(); ++i) speeds.push_back(speed(wheel, i, usual_s));
  if (speeds.empty()) return std::nullopt;
  const auto usual = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() * 9 / 10);
  std::ranges::nth_element(speeds, usual);
  const double limit = std::max(kFast, 3.0 * *usual);
  Trajectory smooth{wheel.front()};
  std::vector<std::size_t> jumps;
  Vector6 twist = Vector6::Zero();
  for (std::size_t i = 1; i < wheel.size(); ++i) {
    const bool is_jump = speed(wheel, i, usual_s) > limit;
    if (is_jump) jumps.push_back(i);
    const Pose step = is_jump ? Pose::exp(twist * interval(wheel, i)) : motion(wheel, i);
    if (!is_jump) twist = step.log() / interval(wheel, i);
    smooth.push_back({wheel[i].stamp, smooth.back().T_world_body * step});
  }
  if (jumps.empty()) return std::nullopt;
  const std::size_t first = jumps.front();
  const bool is_useless = jumps.size() * 50 > wheel.size();
  const std::string sentence =
      format("their position jumps {} times, first by {:.2f} m at {}", jumps.size(),
             motion(wheel, first).translation().norm(), at_second(wheel[first].stamp));
  if (is_useless) {
    wheel.clear();
    return on_wheels(Finding::wheels_jump, Consequence::left_out,
                     sentence + "; they are left out; check the unit (metres) and the driver");
  }
  wheel = std::move(smooth);
  return on_wheels(Finding::wheels_jump, Consequence::repaired,
                   sentence + "; the jumps are taken out; check the encoders' counters for overflow");
}

// Of an IMU: the angle turned about the robot's upward axis, and the integral of the force ahead.
Growths growths_of(const std::vector<ImuSample>& imu, const Pose& T_base_imu) {
  const Vector3 up = T_base_imu.rotation().conjugate() * Vector3::UnitZ();
  const Vector3 ahead = T_base_imu.rotation().conjugate() * Vector3::UnitX();
  Growths out;
  out.turn.add(imu.front().stamp, 0.0);
  out.forward.add(imu.front().stamp, 0.0);
  for (std::size_t i = 1; i < imu.size(); ++i) {
    const double half = 0.5 * to_seconds(imu[i].stamp - imu[i - 1].stamp);
    const Vector3 rates = imu[i].angular_velocity + imu[i - 1].angular_velocity;
    const Vector3 forces = imu[i].specific_force + imu[i - 1].specific_force;
    out.turn.add(imu[i].stamp, out.turn.last() + half * up.dot(rates));
    out.forward.add(imu[i].stamp, out.forward.last() + half * ahead.dot(forces));
  }
  return out;
}

// Of the wheels' acceleration with the force ahead that the IMU feels; 0 where there is little of either.
double forward_correlation(const Growth& wheels, const Growth& imu) {
  constexpr Duration kHalf = std::chrono::milliseconds(200);
  constexpr double kSpeedingUp = 0.05;  // m/s^2
  const Stamp begin = std::max(wheels.begin(), imu.begin());
  const Stamp end = std::min(wheels.end(), imu.end());
  std::vector<double> w, f;
  for (Stamp stamp = begin; stamp <= end; stamp = beyond_gap(wheels, imu, stamp + kRateGrid)) {
    w.push_back((wheels.rate(stamp + kHalf, kHalf) - wheels.rate(stamp - kHalf, kHalf)) /
                (2.0 * to_seconds(kHalf)));
    f.push_back(imu.rate(stamp, 2 * kHalf));
  }
  constexpr std::size_t kTenSeconds = 500;
  const Regression fit = regress(w, f, 0);
  return fit.num < kTenSeconds || fit.sigma < kSpeedingUp ? 0.0 : fit.correlation;
}

constexpr double kScaleTolerance = 0.05;  // share; skid steering is known no better

std::optional<SensorFinding> check_clock(Trajectory& wheel, const WheelComparison& comparison,
                                         const WheelReference& reference) {
  const double late_s = comparison.late_s();
  if (late_s == 0.0) return std::nullopt;
  for (StampedPose& pose : wheel) pose.stamp = pose.stamp - from_seconds(late_s);
  return on_wheels(Finding::wheels_late, Consequence::repaired,
                   format("their stamps are {:.2f} s too {} by {}; they are moved by that; make both drivers "
                          "use one clock",
                          std::abs(late_s), late_s > 0.0 ? "late" : "early", reference.turns));
}

std::optional<SensorFinding> check_sign(bool is_turned, bool is_backward, const WheelReference& reference) {
  if (!is_turned && !is_backward) return std::nullopt;
  const std::string backward = format("count backward as forward by {}", reference.ahead);
  const std::string turned = format("turn against {}", reference.turns);
  const std::string both = format("count backward as forward and turn against {}", reference.turns);
  return on_wheels(Finding::wheels_reversed, Consequence::left_out,
                   format("they are left out, as they {}; check the wiring of the encoders, or {}",
                          !is_turned    ? backward
                          : is_backward ? both
                                        : turned,
                          reference.remedy));
}

// By how much a count is off that is to be multiplied by `factor`; "" where it is near enough.
std::string off_by(double factor) {
  if (std::abs(factor - 1.0) <= kScaleTolerance) return "";
  return format("{:.0f} % too {}", 100.0 * std::abs(1.0 / factor - 1.0), factor < 1.0 ? "far" : "little");
}

std::optional<SensorFinding> check_scale(const WheelComparison& comparison, const WheelReference& reference) {
  const std::string turns = comparison.turns.agrees() ? off_by(comparison.turns.best.slope) : "";
  const std::string ahead = comparison.ahead ? off_by(*comparison.ahead) : "";
  if (turns.empty() && ahead.empty()) return std::nullopt;
  std::string what;
  if (!turns.empty()) what = format("they turn {} by {}", turns, reference.turns);
  if (!ahead.empty())
    what += format("{}they drive {} by {}", what.empty() ? "" : " and ", ahead, reference.ahead);
  return on_wheels(Finding::wheels_wrong_scale, Consequence::noted,
                   what + "; check the wheels' radius and track in the driver");
}

// Odometry does not use what drivers state of their own accuracy, so that it only needs to be said.
std::optional<SensorFinding> check_covariance(const Recording& recording) {
  const std::string of_pose = fault_of_pose_covariance(recording.wheel_covariance.pose);
  const std::string of_twist = fault_of_twist_covariance(recording.wheel_covariance.twist);
  if (of_pose.empty() && of_twist.empty()) return std::nullopt;
  std::string faults;
  if (!of_pose.empty()) faults = format("the covariance of their pose is {}", of_pose);
  if (!of_twist.empty())
    faults += format("{}the covariance of their twist is {}", faults.empty() ? "" : ", and ", of_twist);
  return on_wheels(Finding::wheels_bad_covariance, Consequence::noted,
                   faults + "; adit does not use it, but repair the driver for programs that do");
}

}  // namespace

double WheelComparison::late_s() const {
  constexpr double kUnexplained = 0.7;
  return std::abs(turns.late_s) < clock_tolerance_s || turns.unexplained > kUnexplained ? 0.0 : turns.late_s;
}

std::vector<SensorFinding> judge_wheels(Recording& recording, const WheelComparison& comparison,
                                        const WheelReference& reference) {
  std::vector<SensorFinding> findings;
  const TurnComparison& turns = comparison.turns;
  const bool agree = turns.agrees();
  if (auto sign = check_sign(agree && turns.best.slope < 0.0, comparison.is_backward, reference)) {
    recording.wheel.clear();
    findings.push_back(std::move(*sign));
    return findings;
  }
  if (turns.has_curves() && !agree) {
    findings.push_back(on_wheels(
        Finding::wheels_contradicted, Consequence::noted,
        format("their turns and those of {} differ (correlation {:.2f}); check the wheels' heading and {}",
               reference.turns, turns.best.correlation, reference.mount)));
  }
  const auto keep = [&](std::optional<SensorFinding> finding) {
    if (finding) findings.push_back(std::move(*finding));
  };
  if (agree) keep(check_clock(recording.wheel, comparison, reference));
  keep(check_scale(comparison, reference));
  return findings;
}

std::vector<SensorFinding> check_wheels_alone(Recording& recording) {
  std::vector<SensorFinding> findings;
  for (const auto check : {leave_out_frozen, take_out_jumps})
    if (auto finding = check(recording.wheel)) findings.push_back(std::move(*finding));
  if (auto covariance = check_covariance(recording)) findings.push_back(std::move(*covariance));
  return findings;
}

WheelsCompared check_wheels_with_imu(Recording& recording) {
  if (recording.wheel.size() < 2 || recording.imu.size() < 2) return {};
  constexpr Duration kHalfWindow = std::chrono::milliseconds(60);
  constexpr WheelReference kReference{"the gyroscope", "the accelerometer",
                                      "--mount or --imu-mount if one of these is wrong", "--imu-mount"};
  const Growths wheels = growths_of(recording.wheel);
  const Growths imu = growths_of(recording.imu, recording.T_base_imu);
  WheelComparison comparison;
  comparison.turns = compare_turns(wheels.turn, imu.turn, kHalfWindow);
  comparison.is_backward = forward_correlation(wheels.forward, imu.forward) < -0.3;
  return {judge_wheels(recording, comparison, kReference), comparison.turns.has_curves()};
}

}  // namespace adit

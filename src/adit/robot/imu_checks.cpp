// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "adit/core/angles.hpp"
#include "adit/core/format.hpp"
#include "adit/odometry/imu_integral.hpp"
#include "adit/robot/sensor_checks.hpp"

namespace adit {
namespace {

using Samples = std::vector<ImuSample>;

constexpr double kGravityTolerance = 1.3;   // m/s^2: biases of cheap sensors, and steady acceleration
constexpr double kOneG = 0.2;               // how far from 1 a gravity in g may be
constexpr double kSteepest = 30 * kDegree;  // no floor rises more on average, no mount is off by so little
constexpr Duration kLongestGap = std::chrono::milliseconds(100);  // as sensed_before
constexpr double kFastestTurn = 8.0;         // rad/s, of 99 % of the samples; robots stay far below it
constexpr double kLargestRateSigma = 1.0;    // rad/s: no gyroscope is so noisy
constexpr double kLargestForceSigma = 10.0;  // m/s^2: as much as gravity

SensorFinding of(Finding finding, Consequence consequence, std::string sentence) {
  return {finding, consequence, "imu: " + std::move(sentence)};
}

std::string seconds_of(Stamp stamp) { return format("{:.2f} s", stamp.seconds()); }

double quantile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, at);
  return *at;
}

template <class Value>
std::vector<double> values_of(const Samples& imu, const Value& value) {
  std::vector<double> values;
  values.reserve(imu.size());
  for (const ImuSample& sample : imu) values.push_back(value(sample));
  return values;
}
double force_of(const ImuSample& sample) { return sample.specific_force.norm(); }

// A covariance that cannot be used is one that nothing is known of.
std::optional<SensorFinding> check_covariance(Matrix3& covariance, std::string_view what, double largest) {
  const double highest = covariance.cwiseAbs().maxCoeff();
  std::string fault;
  if (covariance.isZero(0.0)) {
    fault = "not stated (all zero)";
  } else if (!covariance.allFinite() || covariance.llt().info() != Eigen::Success ||
             (covariance - covariance.transpose()).norm() > 1e-6 * highest) {
    fault = "not positive definite";
  } else if (highest > largest * largest) {
    fault = format("huge (standard deviation {:.3g})", std::sqrt(highest));
  } else {
    return std::nullopt;
  }
  covariance.setZero();
  return of(
      Finding::imu_bad_covariance, Consequence::repaired,
      format("the covariance of its {} is {}; it is taken as unknown. adit does not use it, but repair the "
             "driver for programs that do",
             what, fault));
}

// The lengths of the means of half a second each: vibration and noise are no part of them.
template <class Value>
std::vector<double> lengths_of_means(const Samples& imu, const Value& value) {
  constexpr Duration kWindow = std::chrono::milliseconds(500);
  std::vector<double> lengths;
  Vector3 sum = Vector3::Zero();
  std::size_t begin = 0;
  for (std::size_t i = 0; i < imu.size(); ++i) {
    sum += value(imu[i]);
    if (imu[i].stamp - imu[begin].stamp < kWindow && i + 1 < imu.size()) continue;
    lengths.push_back(sum.norm() / static_cast<double>(i + 1 - begin));
    sum.setZero();
    begin = i + 1;
  }
  return lengths;
}

// Units of acceleration, by the gravity that is in it most of the time. Repairs g.
std::optional<SensorFinding> check_gravity(Recording& recording) {
  const double gravity =
      quantile(lengths_of_means(recording.imu, [](const ImuSample& s) { return s.specific_force; }), 0.5);
  if (std::abs(gravity - kGravity) < kGravityTolerance) return std::nullopt;
  if (std::abs(gravity - 1.0) < kOneG) {
    for (ImuSample& sample : recording.imu) sample.specific_force *= kGravity;
    recording.imu_covariance.specific_force *= kGravity * kGravity;
    return of(
        Finding::imu_in_g, Consequence::repaired,
        format("its acceleration is {:.2f} most of the time: g, not m/s^2, as some LiDARs send it; it is "
               "multiplied by {}",
               gravity, kGravity));
  }
  if (gravity < 0.7 * kGravity) {
    return of(Finding::imu_without_gravity, Consequence::left_out,
              format("it is left out, as its acceleration of {:.2f} m/s^2 most of the time has no gravity "
                     "(9.81) in it; let the driver send what the accelerometer measures",
                     gravity));
  }
  return of(Finding::imu_wrong_unit, Consequence::left_out,
            format("it is left out, as its acceleration is {:.4g} most of the time where gravity is 9.81 "
                   "m/s^2; check the driver's unit",
                   gravity));
}

// Sensors that start up send zeros. Leaves them out.
std::optional<SensorFinding> check_start(Samples& imu) {
  constexpr std::ptrdiff_t kFew = 5;  // vibration may cancel gravity for a moment
  const auto begin = std::ranges::find_if(imu, [](const ImuSample& sample) {
    return force_of(sample) > 0.5 * kGravity && force_of(sample) < 2.0 * kGravity;
  });
  if (begin - imu.begin() < kFew || begin == imu.end()) return std::nullopt;
  const std::string sentence = format("it measures no gravity until {}; the {} samples before are left out",
                                      seconds_of(begin->stamp), begin - imu.begin());
  imu.erase(imu.begin(), begin);
  return of(Finding::imu_without_gravity, Consequence::repaired,
            sentence + "; let the robot stand until the sensor runs");
}

// Over a drive accelerations cancel, and what is left of the mean points up.
std::optional<SensorFinding> check_axes(const Recording& recording) {
  Vector3 sum = Vector3::Zero();
  for (const ImuSample& sample : recording.imu) sum += sample.specific_force;
  const Vector3 up = (recording.T_base_imu.rotation() * sum).normalized();
  const double tilt = std::acos(std::clamp(up.z(), -1.0, 1.0));
  if (tilt < kSteepest) return std::nullopt;
  constexpr std::array kNames{"x (forward)", "y (left)", "z (up)"};
  Eigen::Index axis = 0;
  up.cwiseAbs().maxCoeff(&axis);
  return of(
      Finding::imu_wrong_axes, Consequence::left_out,
      format("it is left out, as it feels gravity {:.0f} degrees off the robot's upward axis, along {}{}; "
             "its mount ({}) does not agree with its axes: give --imu-mount",
             tilt / kDegree, up[axis] < 0.0 ? "minus " : "", kNames.at(static_cast<std::size_t>(axis)),
             recording.imu_mount_source));
}

// Values cut off at the end of a range repeat exactly.
struct CutOff {
  std::size_t count = 0;
  Stamp first;
  double limit = 0.0;
};
template <class Member>
CutOff cut_off(const Samples& imu, const Member& member, double least) {
  CutOff worst;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    double limit = 0.0;
    for (const ImuSample& sample : imu) limit = std::max(limit, std::abs(member(sample)[axis]));
    CutOff found{0, {}, limit};
    for (const ImuSample& sample : imu) {
      if (std::abs(member(sample)[axis]) < limit * (1.0 - 1e-9)) continue;
      if (found.count++ == 0) found.first = sample.stamp;
    }
    if (limit >= least && found.count > worst.count) worst = found;
  }
  return worst;
}

std::optional<SensorFinding> check_range(const Samples& imu) {
  constexpr std::size_t kFew = 10;  // values may repeat by chance
  const CutOff rate = cut_off(
      imu, [](const ImuSample& s) { return s.angular_velocity; }, 1.0);
  const CutOff force = cut_off(
      imu, [](const ImuSample& s) { return s.specific_force; }, 1.2 * kGravity);
  const bool is_rate = rate.count > force.count;
  const CutOff& worst = is_rate ? rate : force;
  if (worst.count < kFew) return std::nullopt;
  const bool is_much = worst.count * 100 > imu.size();
  return of(
      Finding::imu_saturated, is_much ? Consequence::left_out : Consequence::noted,
      format("{}{} of {} samples are cut off at {:.4g} {}, first at {}; set a larger range in the driver "
             "or mount it softer",
             is_much ? "it is left out: " : "", worst.count, imu.size(), worst.limit,
             is_rate ? "rad/s" : "m/s^2", seconds_of(worst.first)));
}

std::optional<SensorFinding> check_gaps(const Samples& imu) {
  std::size_t count = 0;
  std::size_t longest = 0;
  for (std::size_t i = 1; i < imu.size(); ++i) {
    const Duration gap = imu[i].stamp - imu[i - 1].stamp;
    if (gap <= kLongestGap) continue;
    ++count;
    if (longest == 0 || gap > imu[longest].stamp - imu[longest - 1].stamp) longest = i;
  }
  if (count == 0) return std::nullopt;
  return of(
      Finding::imu_gaps, Consequence::noted,
      format("it is silent {} times for more than 0.1 s, longest for {:.2f} s at {}; nothing is measured "
             "then, so look for lost messages",
             count, to_seconds(imu[longest].stamp - imu[longest - 1].stamp),
             seconds_of(imu[longest - 1].stamp)));
}

// How far off the direction of gravity is after half a second, when it is turned by the rates times
// `factor`: root mean square, radians.
double gravity_error(const Samples& imu, double factor) {
  constexpr Duration kStep = std::chrono::milliseconds(500);
  double sum = 0.0;
  int count = 0;
  std::size_t begin = 0;
  Eigen::Quaterniond turned = Eigen::Quaterniond::Identity();
  for (std::size_t i = 1; i < imu.size(); ++i) {
    const Duration dt = imu[i].stamp - imu[i - 1].stamp;
    if (dt > kLongestGap) begin = i;
    if (begin == i) turned.setIdentity();
    if (begin == i) continue;
    turned = turned * so3::exp(factor * to_seconds(dt) * imu[i].angular_velocity);
    if (imu[i].stamp - imu[begin].stamp < kStep) continue;
    const Vector3 predicted = turned.conjugate() * imu[begin].specific_force;
    sum += std::pow(
        std::atan2(predicted.cross(imu[i].specific_force).norm(), predicted.dot(imu[i].specific_force)), 2);
    ++count;
    begin = i;
    turned.setIdentity();
  }
  return count == 0 ? 0.0 : std::sqrt(sum / count);
}

// Units of rates, by how gravity turns, and by how fast robots do. Repairs degrees that agree with both.
std::optional<SensorFinding> check_rates(Recording& recording) {
  Samples& imu = recording.imu;
  constexpr double kMuch = 15.0 * kDegree;  // braking and slopes turn what is felt of gravity by less
  const double as_radians = gravity_error(imu, 1.0);
  const double as_degrees = gravity_error(imu, kDegree);
  const auto rate_of = [](const ImuSample& s) -> const Vector3& { return s.angular_velocity; };
  const double fast = quantile(values_of(imu, [&](const ImuSample& s) { return rate_of(s).norm(); }), 0.99);
  const double lasting = quantile(lengths_of_means(imu, rate_of), 0.99);
  const bool is_turned_too_far = as_radians > kMuch && as_radians > 3.0 * as_degrees;
  if (!is_turned_too_far && fast < kFastestTurn) return std::nullopt;
  const std::string found =
      is_turned_too_far ? format(
                              "its rates (up to {:.3g} in 99 % of the samples) are not radians per second, "
                              "by which gravity "
                              "would turn by {:.0f} degrees in half a second, where it does by {:.1f}",
                              fast, as_radians / kDegree, gravity_error(imu, 0.0) / kDegree)
                        : format(
                              "its rates are up to {:.3g} in 99 % of the samples: no robot turns by so many "
                              "radians per second",
                              fast);
  const bool is_noise = lasting < 0.5 * fast;  // which turns a gravity that is predicted by it, too
  const bool are_degrees = !is_noise && (is_turned_too_far || lasting > kFastestTurn);
  if (!are_degrees || as_degrees > kMuch || fast * kDegree > kFastestTurn) {
    return of(Finding::imu_wrong_rates, Consequence::left_out,
              "it is left out: " + found + ", and they are not clearly degrees; check the driver's unit");
  }
  for (ImuSample& sample : imu) sample.angular_velocity *= kDegree;
  recording.imu_covariance.angular_velocity *= kDegree * kDegree;
  return of(Finding::imu_in_degrees, Consequence::repaired,
            found + "; they are taken for degrees per second and converted");
}

}  // namespace

std::vector<SensorFinding> check_imu_alone(Recording& recording) {
  std::vector<SensorFinding> findings;
  const auto keep = [&](std::optional<SensorFinding> finding) {
    if (finding) findings.push_back(std::move(*finding));
    const bool is_left_out = !findings.empty() && findings.back().consequence == Consequence::left_out;
    if (is_left_out) recording.imu.clear();
    return !recording.imu.empty();
  };
  if (recording.imu.empty()) return findings;
  if (!keep(check_gravity(recording)) || !keep(check_start(recording.imu))) return findings;
  if (!keep(check_axes(recording)) || !keep(check_rates(recording))) return findings;
  if (!keep(check_range(recording.imu))) return findings;
  keep(check_covariance(recording.imu_covariance.angular_velocity, "angular velocity", kLargestRateSigma));
  keep(check_covariance(recording.imu_covariance.specific_force, "acceleration", kLargestForceSigma));
  keep(check_gaps(recording.imu));
  return findings;
}

}  // namespace adit

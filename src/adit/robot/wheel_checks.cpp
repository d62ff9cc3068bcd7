// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "adit/core/format.hpp"
#include "adit/robot/sensor_checks.hpp"

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
double speed(const Trajectory& wheel, std::size_t i) {
  return motion(wheel, i).translation().norm() / interval(wheel, i);
}

// Wheels that drive and then stand from one value to the next, without braking, for a while: their value no
// longer arrives, or they have left the ground. The frozen values are left out.
std::optional<SensorFinding> leave_out_frozen(Trajectory& wheel) {
  constexpr double kDriving = 0.3;   // m/s
  constexpr double kBraking = 10.0;  // m/s^2: tyres hold no more
  constexpr double kWhile = 0.3;     // seconds
  Trajectory kept;
  std::vector<Stamp> begins;
  double longest = 0.0;
  for (std::size_t i = 0; i < wheel.size(); ++i) {
    kept.push_back(wheel[i]);
    if (i == 0 || speed(wheel, i) < std::max(kDriving, kBraking * interval(wheel, i))) continue;
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
  std::vector<double> speeds;
  for (std::size_t i = 1; i < wheel.size(); ++i) speeds.push_back(speed(wheel, i));
  if (speeds.empty()) return std::nullopt;
  const auto usual = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() * 9 / 10);
  std::ranges::nth_element(speeds, usual);
  const double limit = std::max(kFast, 3.0 * *usual);
  Trajectory smooth{wheel.front()};
  std::vector<std::size_t> jumps;
  Vector6 twist = Vector6::Zero();
  for (std::size_t i = 1; i < wheel.size(); ++i) {
    const bool is_jump = speed(wheel, i) > limit;
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

// A quantity that grows with time, such as an angle turned; linear between the samples.
class Growth {
 public:
  void add(Stamp stamp, double value) {
    stamps_.push_back(stamp);
    values_.push_back(value);
  }
  [[nodiscard]] double last() const { return values_.empty() ? 0.0 : values_.back(); }
  [[nodiscard]] Stamp begin() const { return stamps_.front(); }
  [[nodiscard]] Stamp end() const { return stamps_.back(); }

  /// Not a number outside and where samples are further apart than 0.2 s.
  [[nodiscard]] double at(Stamp stamp) const {
    const auto after = std::ranges::lower_bound(stamps_, stamp);
    if (after == stamps_.end() || (after == stamps_.begin() && *after != stamp)) return kNothing;
    const auto i = static_cast<std::size_t>(after - stamps_.begin());
    if (*after == stamp) return values_[i];
    const double gap = to_seconds(stamps_[i] - stamps_[i - 1]);
    if (gap > 0.2) return kNothing;
    return values_[i - 1] + (values_[i] - values_[i - 1]) * to_seconds(stamp - stamps_[i - 1]) / gap;
  }
  /// The mean rate within `half` of `stamp`, per second.
  [[nodiscard]] double rate(Stamp stamp, Duration half) const {
    return (at(stamp + half) - at(stamp - half)) / (2.0 * to_seconds(half));
  }

 private:
  static constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
  std::vector<Stamp> stamps_;
  std::vector<double> values_;
};

struct Growths {
  Growth turn;
  Growth forward;
};

Growths growths_of(const Trajectory& wheel) {
  Growths out;
  out.turn.add(wheel.front().stamp, 0.0);
  out.forward.add(wheel.front().stamp, 0.0);
  for (std::size_t i = 1; i < wheel.size(); ++i) {
    const Pose step = motion(wheel, i);
    out.turn.add(wheel[i].stamp, out.turn.last() + step.yaw());
    out.forward.add(wheel[i].stamp, out.forward.last() + step.translation().x());
  }
  return out;
}

/// Of an IMU: the angle turned about the robot's upward axis, and the integral of the force ahead.
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

struct Regression {
  std::size_t num = 0;
  double correlation = 0.0;
  double slope = 0.0;  ///< Of y on x.
  double sigma = 0.0;  ///< Standard deviation of x.
};

/// Pairs in which a number is missing do not count.
Regression regress(const std::vector<double>& x, const std::vector<double>& y, std::ptrdiff_t shift) {
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::ptrdiff_t k = static_cast<std::ptrdiff_t>(i) + shift;
    if (k < 0 || k >= static_cast<std::ptrdiff_t>(y.size())) continue;
    const double a = x[i];
    const double b = y[static_cast<std::size_t>(k)];
    if (!std::isfinite(a) || !std::isfinite(b)) continue;
    n += 1.0, sx += a, sy += b, sxx += a * a, sxy += a * b, syy += b * b;
  }
  if (n < 2.0) return {};
  const double vx = sxx / n - sx * sx / (n * n);
  const double vy = syy / n - sy * sy / (n * n);
  const double c = sxy / n - sx * sy / (n * n);
  if (vx <= 0.0 || vy <= 0.0) return {};
  return {static_cast<std::size_t>(n), c / std::sqrt(vx * vy), c / vx, std::sqrt(vx)};
}

constexpr Duration kGrid = std::chrono::milliseconds(20);
constexpr Duration kHalfWindow = std::chrono::milliseconds(60);
constexpr std::ptrdiff_t kMostShift = 25;  // grid steps: half a second
constexpr double kCurves = 0.03;           // rad/s: with less turning there is nothing to compare
constexpr std::size_t kFewPairs = 500;     // ten seconds
constexpr double kClearly = 0.7;           // correlation
constexpr double kLate = 0.04;             // seconds: two grid steps
constexpr double kScaleTolerance = 0.05;   // share; skid steering is known no better

/// The turning of wheels and gyroscope at the shift of clocks at which they agree best.
struct TurnComparison {
  Regression best;           ///< The gyroscope's turning by the wheels'.
  double late_s = 0.0;       ///< By how much the wheels' stamps are too late.
  double unexplained = 1.0;  ///< Share of the error at no shift that is left at the best one.
};

std::vector<double> rates_on_grid(const Growth& growth, Stamp begin, Stamp end) {
  std::vector<double> rates;
  for (Stamp stamp = begin; stamp <= end; stamp = stamp + kGrid)
    rates.push_back(growth.rate(stamp, kHalfWindow));
  return rates;
}

TurnComparison compare_turns(const Growth& wheels, const Growth& gyro) {
  const Stamp begin = std::max(wheels.begin(), gyro.begin());
  const Stamp end = std::min(wheels.end(), gyro.end());
  const std::vector<double> w = rates_on_grid(wheels, begin, end);
  const std::vector<double> g = rates_on_grid(gyro, begin, end);
  const auto strength = [&](std::ptrdiff_t shift) { return std::abs(regress(w, g, shift).correlation); };
  std::ptrdiff_t at = 0;
  for (std::ptrdiff_t shift = -kMostShift; shift <= kMostShift; ++shift)
    if (strength(shift) > strength(at) + 1e-12) at = shift;
  TurnComparison out;
  out.best = regress(w, g, at);
  // The vertex of the parabola through the best shift and its neighbours.
  const double before = strength(at - 1);
  const double after = strength(at + 1);
  const double bend = before - 2.0 * strength(at) + after;
  const double beyond = bend < 0.0 ? 0.5 * (before - after) / bend : 0.0;
  out.late_s = -(static_cast<double>(at) + beyond) * to_seconds(kGrid);
  out.unexplained = (1.0 - std::pow(strength(at), 2)) / std::max(1e-12, 1.0 - std::pow(strength(0), 2));
  return out;
}

/// Of the wheels' acceleration with the force ahead that the IMU feels; 0 where there is little of either.
double forward_correlation(const Growth& wheels, const Growth& imu) {
  constexpr Duration kHalf = std::chrono::milliseconds(200);
  constexpr double kSpeedingUp = 0.05;  // m/s^2
  const Stamp begin = std::max(wheels.begin(), imu.begin());
  const Stamp end = std::min(wheels.end(), imu.end());
  std::vector<double> w, f;
  for (Stamp stamp = begin; stamp <= end; stamp = stamp + kGrid) {
    w.push_back((wheels.rate(stamp + kHalf, kHalf) - wheels.rate(stamp - kHalf, kHalf)) /
                (2.0 * to_seconds(kHalf)));
    f.push_back(imu.rate(stamp, 2 * kHalf));
  }
  const Regression fit = regress(w, f, 0);
  return fit.num < kFewPairs || fit.sigma < kSpeedingUp ? 0.0 : fit.correlation;
}

std::optional<SensorFinding> check_clock(Trajectory& wheel, const TurnComparison& turns) {
  if (std::abs(turns.late_s) < kLate || turns.unexplained > 0.7) return std::nullopt;
  for (StampedPose& pose : wheel) pose.stamp = pose.stamp - from_seconds(turns.late_s);
  return on_wheels(Finding::wheels_late, Consequence::repaired,
                   format("their stamps are {:.2f} s too {} by the gyroscope; they are moved by that; make "
                          "both drivers use one clock",
                          std::abs(turns.late_s), turns.late_s > 0.0 ? "late" : "early"));
}

std::optional<SensorFinding> check_sign(double turn_slope, double forward) {
  const bool is_turned = turn_slope < 0.0;
  const bool is_backward = forward < -0.3;
  if (!is_turned && !is_backward) return std::nullopt;
  const char* what = !is_turned    ? "count backward as forward by the accelerometer"
                     : is_backward ? "count backward as forward and turn against the gyroscope"
                                   : "turn against the gyroscope";
  return on_wheels(
      Finding::wheels_reversed, Consequence::left_out,
      format("they are left out, as they {}; check the wiring of the encoders, or --imu-mount if "
             "the IMU is the one that is wrong",
             what));
}

}  // namespace

std::vector<SensorFinding> check_wheels_alone(Recording& recording) {
  std::vector<SensorFinding> findings;
  for (const auto check : {leave_out_frozen, take_out_jumps})
    if (auto finding = check(recording.wheel)) findings.push_back(std::move(*finding));
  return findings;
}

std::vector<SensorFinding> check_wheels_with_imu(Recording& recording) {
  std::vector<SensorFinding> findings;
  if (recording.wheel.size() < 2 || recording.imu.size() < 2) return findings;
  const Growths wheels = growths_of(recording.wheel);
  const Growths imu = growths_of(recording.imu, recording.T_base_imu);
  const TurnComparison turns = compare_turns(wheels.turn, imu.turn);
  const bool has_curves = turns.best.num >= kFewPairs && turns.best.sigma >= kCurves;
  const bool agree = has_curves && std::abs(turns.best.correlation) >= kClearly;
  const double forward = forward_correlation(wheels.forward, imu.forward);
  if (auto sign = check_sign(agree ? turns.best.slope : 1.0, forward)) {
    recording.wheel.clear();
    findings.push_back(std::move(*sign));
    return findings;
  }
  if (has_curves && !agree) {
    findings.push_back(on_wheels(
        Finding::wheels_contradicted, Consequence::noted,
        format("their turns and the gyroscope's differ (correlation {:.2f}); check the wheels' heading and "
               "--imu-mount",
               turns.best.correlation)));
  }
  if (!agree) return findings;
  if (auto clock = check_clock(recording.wheel, turns)) findings.push_back(std::move(*clock));
  if (std::abs(turns.best.slope - 1.0) > kScaleTolerance) {
    findings.push_back(on_wheels(
        Finding::wheels_wrong_scale, Consequence::noted,
        format("they turn {:.0f} % too {} by the gyroscope; check the wheels' radius and track in the driver",
               100.0 * std::abs(1.0 / turns.best.slope - 1.0), turns.best.slope < 1.0 ? "far" : "little")));
  }
  return findings;
}

}  // namespace adit

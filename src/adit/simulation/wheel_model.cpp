// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/wheel_model.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/angles.hpp"
#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"
#include "adit/simulation/faults.hpp"

namespace adit {
namespace {

constexpr std::string_view kSlip = "slip";
constexpr std::string_view kSpin = "spin";
constexpr std::string_view kLift = "lift";
constexpr std::string_view kFreeze = "freeze";
constexpr std::string_view kJump = "jump";
constexpr std::string_view kSilence = "silent";
constexpr std::array kWheelFaults{FaultKind{kSlip, FaultAmount::needed},
                                  FaultKind{kSpin, FaultAmount::needed},
                                  FaultKind{kLift},
                                  FaultKind{kFreeze},
                                  FaultKind{kJump, FaultAmount::needed},
                                  FaultKind{kSilence}};
constexpr std::uint64_t kBurstStream = 0x6275727374;  // numbers of their own for the bursts

// What the wheels travel beside what the robot does.
struct Disturbance {
  double slip = 0.0;  // metres too far per metre
  double spin = 0.0;  // metres per second
  bool lifted = false;
};

Disturbance disturbance_at(const std::vector<SensorFault>& faults, Stamp stamp) {
  Disturbance now;
  for (const SensorFault& fault : faults) {
    if (stamp < fault.begin || stamp >= fault.end) continue;
    if (fault.kind == kSlip) now.slip += fault.amount;
    if (fault.kind == kSpin) now.spin += fault.amount;
    if (fault.kind == kLift) now.lifted = true;
  }
  return now;
}

// The wheels' share of a true motion.
struct Roll {
  double ahead;
  double turn;
};

Roll disturbed(const Roll& roll, const Disturbance& now, double seconds) {
  if (now.lifted) return {now.spin * seconds, 0.0};
  return {roll.ahead * (1.0 + now.slip) + now.spin * seconds, roll.turn};
}

Roll wired(const Roll& roll, const WheelConfig& config) {
  const double ahead = config.sign == WheelSign::reversed ? -config.scale : config.scale;
  const double turn = config.sign == WheelSign::correct ? config.scale : -config.scale;
  return {roll.ahead * ahead, roll.turn * turn};
}

// A jump moves all poses of its stretch by the same, along the heading that the robot has when it begins.
Trajectory with_jumps(Trajectory odometry, const std::vector<SensorFault>& faults) {
  for (const SensorFault& fault : faults) {
    if (fault.kind != kJump) continue;
    const auto begin = std::ranges::lower_bound(odometry, fault.begin, {}, &StampedPose::stamp);
    const auto end = std::ranges::lower_bound(odometry, fault.end, {}, &StampedPose::stamp);
    if (begin == odometry.end()) continue;
    const Pose& T = begin->T_world_body;
    const Pose moved = T * Pose::translation_of(fault.amount, 0.0, 0.0) * T.inverse();
    for (auto at = begin; at != end; ++at) at->T_world_body = moved * at->T_world_body;
  }
  return odometry;
}

// What becomes of the odometry between the wheels and the recording.
Trajectory reported(const Trajectory& odometry, const std::vector<SensorFault>& faults, Duration offset) {
  Trajectory out;
  for (const StampedPose& pose : with_jumps(odometry, faults)) {
    if (is_faulty(faults, kSilence, pose.stamp)) continue;
    const bool is_frozen = is_faulty(faults, kFreeze, pose.stamp) && !out.empty();
    out.push_back({pose.stamp + offset, is_frozen ? out.back().T_world_body : pose.T_world_body});
  }
  return out;
}

std::vector<Stamp> odometry_stamps(const Trajectory& truth, double rate_hz) {
  std::vector<Stamp> stamps;
  const Stamp first = truth.front().stamp;
  const Stamp last = truth.back().stamp;
  for (std::int64_t i = 0;; ++i) {
    const Stamp stamp = first + from_seconds(static_cast<double>(i) / rate_hz);
    if (stamp >= last) break;
    stamps.push_back(stamp);
  }
  stamps.push_back(last);
  return stamps;
}

// One robot's wheels: its constants, and how they err from step to step.
class Wheels {
 public:
  Wheels(const WheelConfig& config, std::uint64_t seed)
      : config_(config),
        rng_(seed),
        scale_(1.0 + config.scale_sigma * rng_.normal()),
        turn_scale_(1.0 + config.turn_scale_sigma * rng_.normal()),
        drift_(config.yaw_drift_deg * kDegree / 100.0 * rng_.normal()),
        slip_(config.slip_sigma * rng_.normal()) {}

  /// Turns the wheels by a true motion (metres ahead, radians to the left). Returns the motion that odometry
  /// computes from the new ticks.
  Pose2 roll(double ahead, double turn, double seconds) {
    const double distance = std::abs(ahead);
    const double yaw_walk = config_.yaw_walk_deg * kDegree * std::sqrt(distance / 100.0) * rng_.normal();
    advance_slip(seconds);
    const double travel = ahead * scale_ * (1.0 + slip_);
    const double spread = 0.5 * config_.effective_track * (turn * turn_scale_ + drift_ * distance + yaw_walk);
    const double left = left_.roll(travel - spread, config_.tick);
    const double right = right_.roll(travel + spread, config_.tick);
    return Pose2::exp({0.5 * (left + right), 0.0, (right - left) / config_.effective_track});
  }

 private:
  struct Encoder {
    double travel = 0.0;
    double counted = 0.0;

    /// The travel of the new ticks. Ticks are counted over all travel so far, so that no remainder is lost.
    double roll(double distance, double tick) {
      travel += distance;
      const double before = counted;
      counted = tick > 0.0 ? tick * std::round(travel / tick) : travel;
      return counted - before;
    }
  };

  // First-order Gauss-Markov process with standard deviation slip_sigma.
  void advance_slip(double seconds) {
    const double keep = std::exp(-seconds / config_.slip_time);
    slip_ = keep * slip_ + std::sqrt(1.0 - keep * keep) * config_.slip_sigma * rng_.normal();
  }

  WheelConfig config_;
  Rng rng_;
  double scale_;
  double turn_scale_;
  double drift_;  // radians per metre
  double slip_;
  Encoder left_;
  Encoder right_;
};

}  // namespace

std::string_view to_string(WheelSign sign) {
  switch (sign) {
    case WheelSign::correct:
      return "correct";
    case WheelSign::reversed:
      return "reversed";
    case WheelSign::swapped:
      return "swapped";
  }
  return "unknown";
}

WheelConfig field_wheels(WheelConfig config) {
  config.burst_rate = 0.5;
  config.burst_time = 1.0;
  config.burst_min = 0.05;
  config.burst_max = 0.3;
  return config;
}

Result<> check_wheels(WheelConfig config) {
  if (Result<> fields = check_fields(fields_of(config)); !fields) return fail("wheels", fields.error());
  const auto faults = parse_faults(config.faults, "wheels", kWheelFaults, Stamp{});
  if (!faults) return fail("wheels", faults.error());
  if (config.burst_min <= config.burst_max) return {};
  return fail("wheels: burst_min must not be above burst_max");
}

std::vector<SensorFault> wheel_faults(const Trajectory& truth, const WheelConfig& config,
                                      std::uint64_t seed) {
  ADIT_CHECK(!truth.empty(), "the true trajectory has a pose");
  const Stamp start = truth.front().stamp;
  Result<std::vector<SensorFault>> listed = parse_faults(config.faults, "wheels", kWheelFaults, start);
  ADIT_CHECK(listed.has_value(), "the wheels' configuration passes check_wheels");
  std::vector<SensorFault> faults = std::move(*listed);
  Rng rng(mix64(seed, kBurstStream));
  const double minutes_between = 1.0 / std::max(config.burst_rate, 1e-9);
  // Exponential pauses: bursts come at any time with the same probability.
  const auto pause = [&] {
    return from_seconds(std::min(1e9, -60.0 * minutes_between * std::log1p(-rng.uniform())));
  };
  for (Stamp begin = start + pause(); begin < truth.back().stamp; begin = faults.back().end + pause()) {
    const Duration lasting = from_seconds(config.burst_time * rng.uniform(0.5, 1.5));
    faults.push_back({"wheels", std::string(kSlip), begin, begin + lasting,
                      rng.uniform(config.burst_min, config.burst_max)});
  }
  std::ranges::stable_sort(faults, {}, &SensorFault::begin);
  return faults;
}

Trajectory wheel_odometry(const Trajectory& truth, const WheelConfig& config, std::uint64_t seed) {
  ADIT_CHECK(!truth.empty(), "the true trajectory has a pose");
  const std::vector<SensorFault> faults = wheel_faults(truth, config, seed);
  Wheels wheels(config, seed);
  Pose2 T_odom_base;
  StampedPose last = truth.front();
  Trajectory odometry;
  for (const Stamp stamp : odometry_stamps(truth, config.rate_hz)) {
    const StampedPose now{stamp, *pose_at(truth, stamp)};
    const Vector6 motion = (last.T_world_body.inverse() * now.T_world_body).log();
    const double seconds = to_seconds(now.stamp - last.stamp);
    if (seconds > 0.0) {
      const Roll rolled = disturbed({motion[0], motion[5]}, disturbance_at(faults, last.stamp), seconds);
      const Roll counted = wired(rolled, config);
      T_odom_base = T_odom_base * wheels.roll(counted.ahead, counted.turn, seconds);
    }
    const Eigen::Vector2d& p = T_odom_base.translation();
    odometry.push_back({stamp, Pose::planar(p.x(), p.y(), T_odom_base.theta())});
    last = now;
  }
  return reported(odometry, faults, from_seconds(config.time_offset));
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/wheel_model.hpp"

#include <cmath>

#include "adit/core/angles.hpp"
#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

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

Trajectory wheel_odometry(const Trajectory& truth, const WheelConfig& config, std::uint64_t seed) {
  ADIT_CHECK(!truth.empty(), "the true trajectory has a pose");
  Wheels wheels(config, seed);
  Pose2 T_odom_base;
  StampedPose last = truth.front();
  Trajectory odometry;
  for (const Stamp stamp : odometry_stamps(truth, config.rate_hz)) {
    const StampedPose now{stamp, *pose_at(truth, stamp)};
    const Vector6 motion = (last.T_world_body.inverse() * now.T_world_body).log();
    const double seconds = to_seconds(now.stamp - last.stamp);
    if (seconds > 0.0) T_odom_base = T_odom_base * wheels.roll(motion[0], motion[5], seconds);
    const Eigen::Vector2d& p = T_odom_base.translation();
    odometry.push_back({stamp, Pose::planar(p.x(), p.y(), T_odom_base.theta())});
    last = now;
  }
  return odometry;
}

}  // namespace adit

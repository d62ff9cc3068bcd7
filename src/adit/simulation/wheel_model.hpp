// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Wheel odometry of a four-wheel skid-steer robot: what its encoders measure of the true motion.
///
/// Skid steering is a differential drive whose effective track is wider than the real one (Mandow et al.,
/// "Experimental kinematics for wheeled skid-steer mobile robots", IROS 2007): left, right = v -+ omega *
/// track / 2.
#pragma once

#include <cstdint>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"

namespace adit {

/// Standard deviations describe how robots differ from one another, or how one robot errs over time; the seed
/// draws the values.
struct WheelConfig {
  double rate_hz = 50.0;
  double effective_track = 0.9;
  double tick = 0.0005;
  double scale_sigma = 0.005;
  double yaw_drift_deg = 0.5;
  double yaw_walk_deg = 0.5;
  double turn_scale_sigma = 0.01;
  double slip_sigma = 0.02;
  double slip_time = 1.0;
};

inline Fields fields_of(WheelConfig& c) {
  return {
      {"rate_hz", &c.rate_hz, "Hz", 1, 1000, "odometry poses per second"},
      {"effective_track", &c.effective_track, "m", 0.1, 10, "track of the equivalent differential drive"},
      {"tick", &c.tick, "m", 0, 0.1, "wheel travel between two encoder ticks; 0: continuous"},
      {"scale_sigma", &c.scale_sigma, "", 0, 0.2, "relative error of the wheel radius, constant per robot"},
      {"yaw_drift_deg", &c.yaw_drift_deg, "deg", 0, 90, "heading drift over 100 m, constant per robot"},
      {"yaw_walk_deg", &c.yaw_walk_deg, "deg", 0, 90, "random walk of the heading after 100 m"},
      {"turn_scale_sigma", &c.turn_scale_sigma, "", 0, 0.5, "relative error of turns, constant per robot"},
      {"slip_sigma", &c.slip_sigma, "", 0, 0.5, "relative slip along the path, varies over slip_time"},
      {"slip_time", &c.slip_time, "s", 0.01, 100, "correlation time of the slip"}};
}

/// Dead reckoning from the encoders of one robot: T_wheelodom_base in the plane (z, roll and pitch stay 0),
/// identity at the first stamp of `truth`, then at `rate_hz` until the end of `truth`, whose last stamp is
/// always included. `truth`: T_world_base, not empty. While the wheels stand the pose repeats exactly.
[[nodiscard]] Trajectory wheel_odometry(const Trajectory& truth, const WheelConfig& config,
                                        std::uint64_t seed);

}  // namespace adit

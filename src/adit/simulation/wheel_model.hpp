// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Wheel odometry of a four-wheel skid-steer robot: what its encoders measure of the true motion.
///
/// Skid steering is a differential drive whose effective track is wider than the real one (Mandow et al.,
/// "Experimental kinematics for wheeled skid-steer mobile robots", IROS 2007): left, right = v -+ omega *
/// track / 2.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"

namespace adit {

/// How the encoders are wired.
enum class WheelSign {
  correct,
  reversed,  ///< Forward counts as backward, left as right.
  swapped,   ///< The left wheels count as the right ones: turns have the wrong sign.
};
/// All wirings, for configurations.
inline constexpr std::array kWheelSigns{WheelSign::correct, WheelSign::reversed, WheelSign::swapped};
/// As configurations name it: "reversed".
[[nodiscard]] std::string_view to_string(WheelSign sign);

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

  // What goes wrong, off by default.
  bool on = true;
  WheelSign sign = WheelSign::correct;
  double scale = 1.0;
  double time_offset = 0.0;
  double burst_rate = 0.0;  ///< Bursts of slip per minute, at random.
  double burst_time = 2.0;  ///< Their mean duration; they are drawn from half to one and a half of it.
  double burst_min = 0.3;   ///< Their slip is drawn evenly between these.
  double burst_max = 1.0;
  /// Stretches, see faults.hpp: "slip B:E A" the wheels travel 1 + A metres per metre; "spin B:E A" they
  /// travel A m/s more than the robot; "lift B:E" they stand while the robot is moved; "freeze B:E" the value
  /// stays and is right again afterwards; "jump B:E A" the position is A metres ahead, from B to E; "silent
  /// B:E".
  std::string faults;
};

/// The keys are the names of the members; in the configuration of a run they begin with "simulation.wheels.".
inline Fields fields_of(WheelConfig& c) {
  return {
      {"on", &c.on, "", 0, 0, "whether there is wheel odometry"},
      {"rate_hz", &c.rate_hz, "Hz", 1, 1000, "odometry poses per second"},
      {"effective_track", &c.effective_track, "m", 0.1, 10, "track of the equivalent differential drive"},
      {"tick", &c.tick, "m", 0, 0.1, "wheel travel between two encoder ticks; 0: continuous"},
      {"scale_sigma", &c.scale_sigma, "", 0, 0.2, "relative error of the wheel radius, constant per robot"},
      {"yaw_drift_deg", &c.yaw_drift_deg, "deg", 0, 90, "heading drift over 100 m, constant per robot"},
      {"yaw_walk_deg", &c.yaw_walk_deg, "deg", 0, 90, "random walk of the heading after 100 m"},
      {"turn_scale_sigma", &c.turn_scale_sigma, "", 0, 0.5, "relative error of turns, constant per robot"},
      {"slip_sigma", &c.slip_sigma, "", 0, 0.5, "relative slip along the path, varies over slip_time"},
      {"slip_time", &c.slip_time, "s", 0.01, 100, "correlation time of the slip"},
      enum_field("sign", &c.sign, kWheelSigns, "wiring of the encoders; swapped: left for right"),
      {"scale", &c.scale, "", 0.1, 10, "wheel travel reported per true metre"},
      {"time_offset", &c.time_offset, "s", -10, 10, "added to the stamps"},
      {"burst_rate", &c.burst_rate, "1/min", 0, 60, "bursts of slip per minute, at random"},
      {"burst_time", &c.burst_time, "s", 0.1, 60, "their mean duration"},
      {"burst_min", &c.burst_min, "", 0, 10, "least slip of a burst: metres too far per metre"},
      {"burst_max", &c.burst_max, "", 0, 10, "largest slip of a burst"},
      {"faults", &c.faults, "", 0, 0,
       "stretches 'KIND BEGIN:END [AMOUNT], ...' in seconds: slip (amount: metres too far per metre), spin "
       "(m/s too fast), lift, freeze, jump (metres), silent"}};
}

/// The configuration with a burst of slip every two minutes, of 5 to 30 % for a second: loose ground and
/// puddles (wheels pull best at 15 to 20 % of slip and lose their grip beyond: J. Wong, "Theory of Ground
/// Vehicles", 2008, chapter 1; how often is chosen).
[[nodiscard]] WheelConfig field_wheels(WheelConfig config);

/// Ranges of the fields, and the text of the faults.
Result<> check_wheels(WheelConfig config);

/// The stretches that `config.faults` lists, and the bursts that are drawn, by begin. The draw changes none
/// of the wheels' other errors.
[[nodiscard]] std::vector<SensorFault> wheel_faults(const Trajectory& truth, const WheelConfig& config,
                                                    std::uint64_t seed);

/// Dead reckoning from the encoders of one robot: T_wheelodom_base in the plane (z, roll and pitch stay 0),
/// identity at the first stamp of `truth`, then at `rate_hz` until the end of `truth`, whose last stamp is
/// always included; faults apart. `truth`: T_world_base, not empty; `config` passes check_wheels. While the
/// wheels stand the pose repeats exactly.
[[nodiscard]] Trajectory wheel_odometry(const Trajectory& truth, const WheelConfig& config,
                                        std::uint64_t seed);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// From waypoints to the motion of a four-wheeled robot on the floor of a mesh.
///
/// Base frame: origin on the floor plane midway between the four wheels, x forward, y left, z up from the
/// floor.
#pragma once

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/simulation/raycaster.hpp"
#include "adit/simulation/route.hpp"

namespace adit {

struct DriveConfig {
  double sample_rate_hz = 100.0;
  double stand_time = 1.0;
  double acceleration = 0.8;
  double lateral_acceleration = 1.0;
  double corner_length = 1.0;
  double wheelbase = 0.5;
  double track = 0.6;
  double sway_hz = 0.0;         ///< Of a walking body; 0: it does not sway.
  double sway_roll_deg = 2.0;   ///< To both sides, once per period.
  double sway_pitch_deg = 1.0;  ///< Twice per period, as the height.
  double sway_height = 0.02;
};

inline Fields fields_of(DriveConfig& c) {
  return {
      {"sample_rate_hz", &c.sample_rate_hz, "Hz", 10, 1000, "ground-truth poses per second"},
      {"stand_time", &c.stand_time, "s", 0, 60, "time that the robot stands before it drives off"},
      {"acceleration", &c.acceleration, "m/s^2", 0.05, 10, "nominal acceleration and braking"},
      {"lateral_acceleration", &c.lateral_acceleration, "m/s^2", 0.05, 10,
       "nominal limit in curves; the robot slows down to keep it"},
      {"corner_length", &c.corner_length, "m", 0.2, 10,
       "stretch over which corners of the route are rounded"},
      {"wheelbase", &c.wheelbase, "m", 0.1, 5, "distance between front and rear wheels"},
      {"track", &c.track, "m", 0.1, 5, "distance between left and right wheels"},
      {"sway_hz", &c.sway_hz, "Hz", 0, 5, "strides per second of a robot that walks and sways; 0: it drives"},
      {"sway_roll_deg", &c.sway_roll_deg, "deg", 0, 30, "roll to both sides at full speed, once per stride"},
      {"sway_pitch_deg", &c.sway_pitch_deg, "deg", 0, 30, "pitch to both sides, twice per stride"},
      {"sway_height", &c.sway_height, "m", 0, 0.5, "rise above the floor, twice per stride"}};
}

/// Drives `route` over the floor of the mesh (world frame, metres): the robot stands for a while, then
/// follows the smoothed line with the route's mean speed (over the time it moves), slower in curves, speeding
/// up at the start and braking at the end. Poses are T_world_base at `sample_rate_hz` from `start` on, ending
/// with the robot at rest. With `sway_hz` the body rolls, pitches and rises while it moves, in proportion to
/// its speed.
///
/// Fails, naming robot, waypoint and position, when there are fewer than two distinct waypoints, a number is
/// not finite, no floor lies between 1.5 m above and 3 m below a waypoint, or a wall stands between two
/// waypoints (0.5 m above the floor).
[[nodiscard]] Result<Trajectory> drive(const Raycaster& raycaster, const Route& route,
                                       const DriveConfig& config, Stamp start);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// From waypoints to the motion of a four-wheeled robot on the floor of a mesh.
///
/// Base frame: origin on the floor plane midway between the four wheels, x forward, y left, z up from the
/// floor.
#pragma once

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/simulation/manoeuvres.hpp"
#include "adit/simulation/raycaster.hpp"
#include "adit/simulation/route.hpp"

namespace adit {

/// The vehicle and how it is driven. Lengths in metres, times in seconds.
struct DriveConfig {
  double sample_rate_hz = 100.0;
  double stand_time = 1.0;
  double acceleration = 0.8;
  double lateral_acceleration = 1.0;
  double corner_length = 1.0;
  double wheelbase = 0.5;
  double track = 0.6;
  double sway_hz = 0.0;         ///< Of a body on legs or a suspension; 0: it does not sway.
  double sway_roll_deg = 2.0;   ///< To both sides, once per period.
  double sway_pitch_deg = 1.0;  ///< Twice per period, as the height.
  double sway_height = 0.02;
  double bump_height = 0.0;  ///< Standard deviation of an uneven floor that scans do not show.
  ManoeuvreConfig manoeuvres;
};

/// The keys are the names of the members, those of `manoeuvres` behind "manoeuvres."; in the configuration of
/// a run they begin with "simulation.drive.".
inline Fields fields_of(DriveConfig& c) {
  Fields fields{
      {"sample_rate_hz", &c.sample_rate_hz, "Hz", 10, 1000, "ground-truth poses per second"},
      {"stand_time", &c.stand_time, "s", 0, 60, "time that the robot stands before it drives off"},
      {"acceleration", &c.acceleration, "m/s^2", 0.05, 10, "nominal acceleration and braking"},
      {"lateral_acceleration", &c.lateral_acceleration, "m/s^2", 0.05, 10,
       "nominal limit in curves; the robot slows down to keep it"},
      {"corner_length", &c.corner_length, "m", 0.2, 10,
       "stretch over which corners of the route are rounded"},
      {"wheelbase", &c.wheelbase, "m", 0.1, 5, "distance between front and rear wheels"},
      {"track", &c.track, "m", 0.1, 5, "distance between left and right wheels"},
      {"sway_hz", &c.sway_hz, "Hz", 0, 5,
       "how often the body sways, to a tenth, on legs or a suspension; 0: never"},
      {"sway_roll_deg", &c.sway_roll_deg, "deg", 0, 30, "roll to both sides at full speed, once per stride"},
      {"sway_pitch_deg", &c.sway_pitch_deg, "deg", 0, 30, "pitch to both sides, twice per stride"},
      {"sway_height", &c.sway_height, "m", 0, 0.5, "rise above the floor, twice per stride"},
      {"bump_height", &c.bump_height, "m", 0, 0.1, "bumps under the wheels, metre by metre (sigma)"}};
  append(fields, "manoeuvres", fields_of(c.manoeuvres));
  return fields;
}

/// The configuration with motion as in practice: a body on its suspension, which rolls by half a degree
/// at 1.3 Hz (bodies of cars swing at 1 to 1.5 Hz: T. Gillespie, "Fundamentals of Vehicle Dynamics", 1992,
/// chapter 5), bumps of 1 cm under the wheels (class D of ISO 8608, a poor gravel road, has as much in waves
/// of up to 10 m; these are shorter), field_manoeuvres().
[[nodiscard]] DriveConfig field_drive(DriveConfig config);
/// The configuration without any of these.
[[nodiscard]] DriveConfig ideal_drive(DriveConfig config);

/// Whether the body moves otherwise than steadily within a tenth of a second.
[[nodiscard]] bool is_unsteady(const DriveConfig& config);

/// Drives `route` over the floor of the mesh (world frame, metres): the robot stands for a while, then
/// follows the smoothed line with the route's mean speed (over the time it moves), slower in curves, speeding
/// up at the start and braking at the end; `seed` draws where it halts. Poses are T_world_base at
/// `sample_rate_hz` from `start` on, ending with the robot at rest. With `sway_hz` the body rolls, pitches
/// and rises while it moves, in proportion to its speed; `seed` draws how fast, to a tenth, and the phases.
///
/// Fails, naming robot, waypoint and position, when there are fewer than two distinct waypoints, a number is
/// not finite, no floor lies between 1.5 m above and 3 m below a waypoint, or a wall stands between two
/// waypoints (0.5 m above the floor).
[[nodiscard]] Result<Trajectory> drive(const Raycaster& raycaster, const Route& route,
                                       const DriveConfig& config, Stamp start, std::uint64_t seed = 0);

}  // namespace adit

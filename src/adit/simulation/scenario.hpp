// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/simulation/air.hpp"
#include "adit/simulation/drawn_conditions.hpp"
#include "adit/simulation/fleet_traffic.hpp"
#include "adit/simulation/imu_model.hpp"
#include "adit/simulation/lidar_model.hpp"
#include "adit/simulation/surface_signal.hpp"
#include "adit/simulation/trajectory.hpp"
#include "adit/simulation/visit.hpp"
#include "adit/simulation/wheel_model.hpp"
#include "adit/simulation/world.hpp"

namespace adit {

/// What robots carry, how they drive and what they meet: all that a simulation needs besides the world.
struct ScenarioConfig {
  LidarConfig lidar;
  /// Names of presets, separated by commas, for fleets of different sensors: robots have them in turn,
  /// mounted as `lidar` is. Empty: all have `lidar`.
  std::string lidars;
  LidarErrorConfig lidar_errors;
  SurfaceConfig surfaces;
  AirConfig air;
  VisitConfig visits;
  TrafficConfig traffic;
  double spread = 0.0;  ///< By which sites and visits differ from what is stated; see drawn_conditions.hpp.
  WheelConfig wheels;
  ImuConfig imu;
  DriveConfig drive;
  std::uint64_t seed = 1;
};

/// The keys are the names of the members, those of nested ones behind their name and a dot; in the
/// configuration of a run they begin with "simulation.".
inline Fields fields_of(ScenarioConfig& c) {
  Fields fields{{"seed", &c.seed, "", 0, 1e15, "seed of all noise of sensors and wheels"}};
  fields.push_back({"lidars", &c.lidars, "", 0, 0,
                    "LiDARs of the robots in turn, as in 'os1-64,vlp-16'; empty: all have the one below"});
  fields.push_back({"spread", &c.spread, "", 0, 2,
                    "of rates and shares of what is met, from site to site and visit to visit: standard "
                    "deviation of the logarithm of rates and of odds"});
  append(fields, "lidar", fields_of(c.lidar));
  append(fields, "lidar_errors", fields_of(c.lidar_errors));
  append(fields, "surfaces", fields_of(c.surfaces));
  append(fields, "air", fields_of(c.air));
  append(fields, "visits", fields_of(c.visits));
  append(fields, "traffic", fields_of(c.traffic));
  append(fields, "wheels", fields_of(c.wheels));
  append(fields, "imu", fields_of(c.imu));
  append(fields, "drive", fields_of(c.drive));
  return fields;
}

/// Which errors sensors have, how robots move, and what changes around them.
enum class Conditions {
  ideal,  ///< Noise alone, and every unit of a sensor is the same.
  /// As in practice: field_lidar_errors(), field_surfaces(), field_air(), field_visits(), field_traffic(),
  /// field_drive(), field_wheels() and field_imu().
  field,
};
/// All conditions, for options and lists of worlds.
inline constexpr std::array kConditions{Conditions::ideal, Conditions::field};
/// As options and lists of worlds name them: "ideal".
[[nodiscard]] std::string_view to_string(Conditions conditions);

/// Puts the conditions into a configuration; sensors and seeds stay as they are.
void set_conditions(Conditions conditions, ScenarioConfig& config);

/// The LiDARs that robots have in turn: those that `lidars` names, or `lidar`. Fails on an unknown name.
[[nodiscard]] Result<std::vector<LidarConfig>> lidars_of(const ScenarioConfig& config);
/// Their names, for tables: "os2-32, os1-64".
[[nodiscard]] std::string sensors_text(const ScenarioConfig& simulation);

/// Drives every route of the world at the same time, each robot on a clock that starts at 0. One recording
/// per route, in their order. No scan is cast or stored now: `read_scan(i)` casts scan i on demand, always
/// the same one, on any thread. Wheels and IMU cover every sweep from its start, their faults and errors of
/// clocks apart; `truth` has a pose at every scan stamp and between them, and is exact up to the jitter of
/// stamps. Recordings state the nominal mounts. Each sensor draws its errors apart from the others.
///
/// Fails on a mesh that `check_mesh` refuses, a field out of range, no route at all, two routes of one name,
/// and routes that `drive` refuses. One phase of progress; may throw `Cancelled` (core/progress.hpp).
[[nodiscard]] Result<std::vector<Recording>> simulate(const World& world, const ScenarioConfig& config);

}  // namespace adit

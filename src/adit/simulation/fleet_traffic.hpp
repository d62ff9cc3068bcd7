// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What drives in a world while a robot does: the other robots, each on its own way, and vehicles.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/geometry/triangle_mesh.hpp"
#include "adit/simulation/raycaster.hpp"

namespace adit {

/// Nothing moves by default.
struct TrafficConfig {
  bool robots = false;             ///< Whether robots see one another.
  double vehicles_per_hour = 0.0;  ///< That meet or overtake each robot while it drives.
};
/// The keys are the names of the members; in the configuration of a run they begin with
/// "simulation.traffic.".
[[nodiscard]] Fields fields_of(TrafficConfig& config);

/// Robots see one another, and a vehicle passes each every five minutes: chosen, not measured.
[[nodiscard]] TrafficConfig field_traffic();

/// A vehicle on the path of one robot, beside it, at twice the robot's pace.
struct DrivingVehicle {
  std::size_t robot = 0;  ///< On whose path.
  Stamp met;              ///< When it is beside that robot.
  double pace = 2.0;      ///< Negative: it comes towards the robot.
  double left = 2.0;      ///< Metres from the path to its middle; negative: to the right.
  double width = 1.9;     ///< Metres; less than that of kVehicle in a narrow tunnel.
};

/// The vehicles that drive along the paths, where tunnels have room for them. `floor` is watertight.
[[nodiscard]] std::vector<DrivingVehicle> draw_vehicles(const Raycaster& floor,
                                                        std::span<const Trajectory> truths,
                                                        const TrafficConfig& config, std::uint64_t seed);

/// The other robots that robot number `robot` could see at that time, within `reach` metres, world frame. All
/// clocks start at 0; a robot that has arrived stands at its end. One that would be in this robot is left
/// out.
[[nodiscard]] TriangleMesh robots_around(std::size_t robot, Stamp stamp, double reach,
                                         std::span<const Trajectory> truths);
/// The same for vehicles, all that there are.
[[nodiscard]] TriangleMesh vehicles_around(std::size_t robot, Stamp stamp, std::span<const Trajectory> truths,
                                           std::span<const DrivingVehicle> vehicles);

/// The body of a robot with that pose.
[[nodiscard]] TriangleMesh robot_body(const Pose& T_world_base);

}  // namespace adit

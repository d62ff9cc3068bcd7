// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What a robot meets in a working mine and another robot does not: vehicles and pallets that stand elsewhere
/// at the next visit, doors, walls that were worked on, people who walk along, dust. And what stands there
/// for all: pipes and cables.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/geometry/triangle_mesh.hpp"
#include "adit/simulation/raycaster.hpp"

namespace adit {

/// All zero, as by default, is an empty world in which nothing changes.
struct VisitConfig {
  double vehicles_per_km = 0.0;  ///< Parked beside the path of each robot.
  double pallets_per_km = 0.0;
  double changed =
      1.0;  ///< Share of what a robot meets of them that no other meets; the rest stands there for all.
  int people = 0;             ///< Who walk with the robot, some ahead of it and some behind.
  double dust = 0.0;          ///< Share of rays that end in dust, near the sensor.
  double doors = 0.0;         ///< Share of the openings beside its path that are closed for one robot alone.
  double blocked_ends = 0.0;  ///< Share of the paths beyond whose end a machine blocks the tunnel.
  double walls_per_km =
      0.0;  ///< Stretches of 20 m with fresh shotcrete or a widened face, for one robot alone.
  double wall_change = 0.3;  ///< Metres, the largest; see changed_walls.hpp.
  double pipes = 0.0;        ///< Share of all paths with pipes and cables on a wall, for all robots.
};
/// The keys are the names of the members; in the configuration of a run they begin with "simulation.visits.".
[[nodiscard]] Fields fields_of(VisitConfig& config);

/// A working mine by day, on average: a vehicle every 250 m and a pallet every 125 m, half of which stay; one
/// person; one opening in five closed, every other way on blocked; two stretches of wall per km that were
/// worked on, by 5 to 30 cm (the classes of support of the Q-system begin at 4 cm of sprayed concrete and end
/// above 15: E. Grimstad and N. Barton, "Updating of the Q-system for NMT", 1993); pipes along half of the
/// way. Counts are chosen, not measured.
[[nodiscard]] VisitConfig field_visits();

/// What stands in the world while each of the robots drives along its `truths` (T_world_base), in their
/// order, world frame, apart from changes of the walls. Things stand at the walls, where a robot that drives
/// that path passes them by 0.5 m or more; where a tunnel has no room for them there are fewer. `floor` is
/// watertight (EdgeRule).
[[nodiscard]] std::vector<TriangleMesh> parked_things(const Raycaster& floor,
                                                      std::span<const Trajectory> truths,
                                                      const VisitConfig& config, std::uint64_t seed);

/// The people around the robot at that time, world frame; empty where nobody walks with it. `truth` covers
/// the time.
[[nodiscard]] TriangleMesh people_around(const Trajectory& truth, Stamp stamp, int num_people);

}  // namespace adit

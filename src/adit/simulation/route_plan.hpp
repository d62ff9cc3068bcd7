// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Plans where robots drive through a mesh that came without routes.
#pragma once

#include <string>
#include <vector>

#include "adit/geometry/triangle_mesh.hpp"
#include "adit/simulation/route.hpp"
#include "adit/simulation/route_config.hpp"

namespace adit {

/// The route of one robot, and how narrow and steep it is.
struct PlannedRoute {
  Route route;               ///< On the floor, world frame of the mesh.
  double clearance_m = 0.0;  ///< Least distance of a waypoint from a wall; 3 m and more are not told apart.
  double slope_deg = 0.0;    ///< Steepest stretch between two waypoints.
};

/// The routes of all robots, and what the floor is like.
struct RoutePlan {
  std::vector<PlannedRoute> robots;  ///< As many as were asked for.
  double floor_m2 = 0.0;             ///< On which the robot can stand and get everywhere.
  double covered = 0.0;              ///< Share of the network's places, 0 to 1, that routes pass.
  std::vector<std::string> notes;    ///< What the user should know of the mesh, one line each.
};

/// Routes named robot_0, robot_1, ... on floor that the robot of `config` can drive on, in the world frame of
/// the mesh (metres, z up), with a waypoint about every metre: each passes floor_line and keeps its
/// clearance. They begin apart at ends of passages; together they cover much of the floor, and each pair
/// shares `config.shared_m` where the network allows. The same mesh, configuration and seed give the same
/// routes.
///
/// Fails, naming a place and the remedy, as check_mesh, check_fields and drivable_floor do, and where the
/// floor is too small for a route of 20 m. Throws ContractViolation unless `num_robots` > 0.
[[nodiscard]] Result<RoutePlan> plan_routes(const TriangleMesh& mesh, std::size_t num_robots,
                                            const RouteConfig& config);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "adit/core/pose.hpp"

namespace adit {

/// Where one robot drives: waypoints on the floor of the world, metres, z up, about one per metre. The robot
/// follows the smoothed line at `speed_mps` on average.
struct Route {
  std::string name;                ///< Of the robot; each route of a world has another.
  double speed_mps = 1.87;         ///< Above 0; stops do not count.
  std::vector<Vector3> waypoints;  ///< In driving order, two or more.
};

/// The length of the polyline through the waypoints, metres.
[[nodiscard]] double length_of(const Route& route);

}  // namespace adit

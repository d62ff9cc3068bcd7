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
  std::string name;
  double speed_mps = 1.87;
  std::vector<Vector3> waypoints;
};

/// The length of the polyline through the waypoints, metres.
[[nodiscard]] double length_of(const Route& route);

}  // namespace adit

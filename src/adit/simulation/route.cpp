// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/route.hpp"

namespace adit {

double length_of(const Route& route) {
  double length = 0.0;
  for (std::size_t i = 1; i < route.waypoints.size(); ++i)
    length += (route.waypoints[i] - route.waypoints[i - 1]).norm();
  return length;
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "adit/core/config.hpp"

namespace adit {

/// The robot that routes are planned for, and how long and how much in common they should be.
struct RouteConfig {
  double width_m = 0.8;
  double height_m = 1.5;
  double clearance_m = 0.2;
  double max_slope_deg = 30.0;
  double max_step_m = 0.15;
  double cell_m = 0.4;
  double length_m = 400.0;
  double shared_m = 60.0;
  double speed_mps = 1.87;
  std::uint64_t seed = 1;

  /// From the middle of the robot to anything else, metres.
  [[nodiscard]] double half_width_m() const { return 0.5 * width_m + clearance_m; }
};

/// The keys are the names of the members; in the configuration of a run they begin with "routes.".
inline Fields fields_of(RouteConfig& c) {
  return {
      {"width_m", &c.width_m, "m", 0.1, 10, "width of the robot, mirrors and mast included"},
      {"height_m", &c.height_m, "m", 0.2, 10, "height of the robot: what hangs lower is in its way"},
      {"clearance_m", &c.clearance_m, "m", 0, 5, "least distance from walls and drops on each side"},
      {"max_slope_deg", &c.max_slope_deg, "deg", 0, 45, "steepest floor, in any direction"},
      {"max_step_m", &c.max_step_m, "m", 0, 0.3,
       "highest kerb or rail that a wheel climbs; what stands higher is in the way"},
      {"cell_m", &c.cell_m, "m", 0.1, 2,
       "spacing of the grid on which floor is looked for; passages need a few cells of width"},
      {"length_m", &c.length_m, "m", 10, 1e5, "longest route; where the network ends sooner, it is shorter"},
      {"shared_m", &c.shared_m, "m", 0, 1e5,
       "path that each pair of robots should have in common, as far as the network allows"},
      {"speed_mps", &c.speed_mps, "m/s", 0.05, 20, "mean speed of the robots"},
      {"seed", &c.seed, "", 0, 9e15, "each seed plans other routes"}};
}

}  // namespace adit

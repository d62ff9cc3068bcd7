// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "adit/simulation/drivable_floor.hpp"

namespace adit {

/// A way between two places that leads past no third one.
struct RouteEdge {
  std::uint32_t to = 0;              ///< Index of a place.
  double length_m = 0.0;             ///< Of the line through the cells, metres.
  std::vector<std::uint32_t> cells;  ///< Of the floor, from place to place, both included.
};

/// A drivable floor reduced to places a few metres apart, in the middle of passages where there is one, and
/// the ways between neighbouring places, which keep away from walls where there is room.
struct RouteNetwork {
  /// A cell of the floor from which ways lead to others.
  struct Place {
    std::uint32_t cell = 0;       ///< Of the floor.
    Vector3 position;             ///< That of the cell.
    std::vector<RouteEdge> ways;  ///< By ascending `to`; each has its reverse at the other place.
  };
  std::vector<Place> places;  ///< By ascending cell.

  /// Whether one cannot drive on through a place: the end of a passage.
  [[nodiscard]] bool is_end(std::uint32_t place) const;
};

/// `spacing`: least distance between places along the floor, metres.
[[nodiscard]] RouteNetwork route_network(const DrivableFloor& floor, const RouteConfig& config,
                                         double spacing);

/// Along the ways of the network from `from` to each place, metres; infinite where none leads. `before`, if
/// given, receives the place before each on the shortest way (of `from`: itself).
[[nodiscard]] std::vector<double> distances_from(const RouteNetwork& network, std::uint32_t from,
                                                 std::vector<std::uint32_t>* before = nullptr);

}  // namespace adit

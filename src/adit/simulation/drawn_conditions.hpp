// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Conditions state what is usual; one site has more of it and another less, and so has one visit. Rates and
/// amounts are drawn log-normal about what is usual, and shares by their odds, none farther out than two
/// standard deviations (decision 0087).
#pragma once

#include <cstdint>

#include "adit/simulation/air.hpp"
#include "adit/simulation/visit.hpp"

namespace adit {

/// Of one site: how much stands in it, how much of that has changed at the next visit, and how much it was
/// worked on. People and dust stay as they are. `spread`: standard deviation of the logarithms of rates and
/// of odds; 0: all is as it is usual.
[[nodiscard]] VisitConfig drawn_site(VisitConfig usual, double spread, std::uint64_t seed);

/// What comes and goes around one robot.
struct DrawnVisit {
  int people = 0;      ///< Who walk with it.
  double dust = 0.0;   ///< Share of rays that end in dust near the sensor.
  AirConfig air = {};  ///< Of its visit.
};
/// Of one robot; the number of people is drawn too (Poisson), where `spread` is not 0.
[[nodiscard]] DrawnVisit drawn_visit(const VisitConfig& usual, const AirConfig& air, double spread,
                                     std::uint64_t seed);

}  // namespace adit

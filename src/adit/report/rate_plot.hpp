// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "adit/report/svg.hpp"

namespace adit {

/// Where both axes of `plot_rates` end. They begin at 1.
inline constexpr double kLeastRate = 1e-5;

/// One curve of `plot_rates`.
struct RateCurve {
  std::string label;                    ///< As the legend names it.
  std::vector<Eigen::Vector2d> points;  ///< {claimed, observed}, above 0 to 1, claimed descending.
  Rgba color;                           ///< As in Stroke.
  Dash dash = Dash::none;               ///< As in Stroke.
};

/// Rates of wrong decisions that something claims, beside those that were observed.
struct RateFigure {
  std::string title;              ///< One line.
  std::string note;               ///< The line below it: of how many, and what limits assume.
  std::vector<RateCurve> curves;  ///< Later ones cover earlier ones; those without points are left out.
  double rate_in_use = 1.0;       ///< Claimed rate that is marked where the axis has it.
  std::string absent = {};        ///< Stands in the middle; for a figure that lacks its data.
};

/// Observed over claimed rates, both logarithmic from 1 to kLeastRate, a self-contained SVG document. What
/// claims too little lies above the diagonal. Rates beyond the ends are drawn at them; throws
/// ContractViolation on one that is not above 0.
[[nodiscard]] std::string plot_rates(const RateFigure& figure);

}  // namespace adit

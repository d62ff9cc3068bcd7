// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace adit {

/// One curve of `plot_shares`.
struct ShareCurve {
  std::string label;                    ///< As the legend names it. Its place in the list decides its colour.
  std::vector<Eigen::Vector2d> points;  ///< {x, share}, x ascending from 0, shares 0 to 1.
};

/// Shares over one quantity, a self-contained SVG document. `longest_x` is where the axis ends, above 0.
[[nodiscard]] std::string plot_shares(std::span<const ShareCurve> curves, double longest_x,
                                      const std::string& x_title, const std::string& y_title);

}  // namespace adit

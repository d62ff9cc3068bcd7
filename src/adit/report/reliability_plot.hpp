// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

namespace adit {

/// Of one source of errors: share that its covariances claim to hold, share that they hold.
struct ReliabilityCurve {
  std::string label;                    ///< As the legend names it.
  std::vector<Eigen::Vector2d> points;  ///< {claimed, observed}, both 0 to 1, claimed ascending.
};

/// Observed over claimed shares, a self-contained SVG document. True covariances lie on the diagonal; above
/// it they are too cautious, below it too confident.
[[nodiscard]] std::string plot_reliability(std::span<const ReliabilityCurve> curves);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The figures of loops and of the hypotheses about merges, each a self-contained SVG document.
#pragma once

#include <array>
#include <string>

#include "adit/evaluation/study_result.hpp"

namespace adit {

/// Every map of a fleet, those that share nothing side by side in frames of their own, with the loops in use
/// (green, solid), refused (red, dashed) and weak (blue, dotted). Robot i of the map has colour i.
[[nodiscard]] std::string plot_loop_map(const LoopMap& map);

/// So many hypotheses are drawn at most; the plot says how many are not.
inline constexpr std::size_t kHypothesesDrawn = 4;

/// The first robot's path, and over it that of the second as each hypothesis says: the best one solid, the
/// others broken; dots where their loops lie. `robots` are the colours.
[[nodiscard]] std::string plot_hypotheses(const MergePicture& merge, std::array<std::size_t, 2> robots);

}  // namespace adit

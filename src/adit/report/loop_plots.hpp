// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The figures of loops and of the hypotheses about merges, each a self-contained SVG document.
#pragma once

#include <array>
#include <string>

#include "adit/evaluation/study_result.hpp"

namespace adit {

/// All maps of a fleet, separate ones side by side in their own frames, with the loops in use (green, solid),
/// refused (red, dashed) and weak (blue, dotted). Robot i of the map has colour i.
[[nodiscard]] std::string plot_loop_map(const LoopMap& map);

/// At most this many hypotheses are drawn; the caption says how many are not.
inline constexpr std::size_t kHypothesesDrawn = 4;

/// The first robot's path, and over it that of the second as each hypothesis says: the best one solid, the
/// others broken; dots where their loops lie. `robots` are the colours.
[[nodiscard]] std::string plot_hypotheses(const MergePicture& merge, std::array<std::size_t, 2> robots);

}  // namespace adit

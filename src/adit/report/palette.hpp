// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Colours and axis ticks that all figures share. The colours can be told apart under the common
/// colour-vision deficiencies.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "adit/evaluation/study_result.hpp"
#include "adit/report/png.hpp"

namespace adit {

inline constexpr Rgba kInk = {31, 41, 51};         ///< Text.
inline constexpr Rgba kMutedInk = {97, 110, 124};  ///< Axis labels and notes.
inline constexpr Rgba kGrid = {223, 228, 234};     ///< Grid lines of axes, and frames around maps.
inline constexpr Rgba kWall = {98, 110, 122};      ///< Walls in floor plans, whose density is the opacity.
inline constexpr Rgba kWhite = {255, 255, 255};    ///< Rims of dots and paths, and numbers on dots.

/// The robot's colour; colours repeat after eight robots.
[[nodiscard]] Rgba robot_color(std::size_t robot);
/// Green, red, blue.
[[nodiscard]] Rgba loop_color(LoopClass loop_class);
/// Green, red, blue.
[[nodiscard]] Rgba fate_color(LoopFate fate);
/// The colour of method i in a comparison.
[[nodiscard]] Rgba method_color(std::size_t method);
/// Perceptually even, dark to bright, for s in [0, 1]; values outside are clamped.
[[nodiscard]] Rgba sequential_color(double s);
/// "#rrggbb".
[[nodiscard]] std::string hex(Rgba color);

/// About `count` round numbers (1, 2 or 5 times a power of ten apart) within [low, high]; low < high.
[[nodiscard]] std::vector<double> nice_ticks(double low, double high, int count);
/// Powers of ten within [low, high], and 2 and 5 times them where fewer than four would be left; 0 < low <
/// high.
[[nodiscard]] std::vector<double> log_ticks(double low, double high);
/// The largest of 1, 2 or 5 times a power of ten that is at most `value`; value > 0.
[[nodiscard]] double round_down_nicely(double value);
/// Shortest text of an axis label: "0.5", "20", "1000".
[[nodiscard]] std::string tick_text(double value);

}  // namespace adit

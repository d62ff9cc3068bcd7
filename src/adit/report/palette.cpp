// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/palette.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"

namespace adit {

Rgba robot_color(std::size_t robot) {
  static constexpr std::array<Rgba, 8> kColors = {{{230, 145, 0},
                                                   {125, 60, 152},
                                                   {70, 170, 225},
                                                   {60, 60, 60},
                                                   {227, 119, 194},
                                                   {140, 140, 20},
                                                   {140, 86, 75},
                                                   {23, 190, 207}}};
  return kColors[robot % kColors.size()];
}

Rgba loop_color(LoopClass loop_class) {
  switch (loop_class) {
    case LoopClass::correct:
      return {0, 158, 96};
    case LoopClass::wrong_place:
      return {214, 39, 40};
    case LoopClass::wrong_registration:
      return {31, 79, 216};
  }
  return kInk;
}

Rgba fate_color(LoopFate fate) {
  switch (fate) {
    case LoopFate::in_use:
      return {0, 158, 96};
    case LoopFate::refused:
      return {214, 39, 40};
    case LoopFate::weak:
      return {31, 79, 216};
  }
  return kInk;
}

Rgba method_color(std::size_t method) {
  static constexpr std::array<Rgba, 4> kColors = {
      {{213, 112, 40}, {0, 114, 178}, {0, 158, 115}, {125, 60, 152}}};
  return kColors[method % kColors.size()];
}

Rgba sequential_color(double s) {
  // Lightness rises evenly from 22 to 80 of 100, so that the order survives in grey; no end vanishes on
  // white.
  static constexpr std::array<std::array<double, 3>, 5> kStops = {
      {{38, 34, 98}, {60, 82, 139}, {33, 145, 140}, {94, 190, 90}, {240, 195, 40}}};
  const double position = std::clamp(s, 0.0, 1.0) * static_cast<double>(kStops.size() - 1);
  const auto below = std::min(static_cast<std::size_t>(position), kStops.size() - 2);
  const auto channel = [&](std::size_t c) {
    return static_cast<std::uint8_t>(std::lround(
        std::lerp(kStops[below][c], kStops[below + 1][c], position - static_cast<double>(below))));
  };
  return {channel(0), channel(1), channel(2)};
}

std::string hex(Rgba color) { return format("#{:02x}{:02x}{:02x}", color.r, color.g, color.b); }

double round_down_nicely(double value) {
  ADIT_CHECK(value > 0.0 && std::isfinite(value), "only positive numbers can be rounded to a power of ten");
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * decade <= value * (1.0 + 1e-12)) return factor * decade;
  }
  return decade;
}

std::vector<double> nice_ticks(double low, double high, int count) {
  ADIT_CHECK(low < high && count > 0, "an axis has a length and ticks");
  const double step = round_down_nicely((high - low) / count * 1.5);
  std::vector<double> ticks;
  for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i += 1.0) {
    ticks.push_back(i * step + 0.0);  // -0 becomes 0
  }
  return ticks;
}

std::vector<double> log_ticks(double low, double high) {
  ADIT_CHECK(low > 0.0 && low < high, "a logarithmic axis has positive ends");
  std::vector<double> decades;
  std::vector<double> all;
  for (double e = std::floor(std::log10(low)); e <= std::log10(high); e += 1.0) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double tick = factor * std::pow(10.0, e);
      if (tick < low * (1.0 - 1e-9) || tick > high * (1.0 + 1e-9)) continue;
      all.push_back(tick);
      if (factor == 1.0) decades.push_back(tick);
    }
  }
  return decades.size() >= 4 ? decades : all;
}

std::string tick_text(double value) { return format("{:.6g}", value); }

}  // namespace adit

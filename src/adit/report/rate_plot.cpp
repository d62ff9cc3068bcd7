// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/rate_plot.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/report/palette.hpp"

namespace adit {
namespace {

constexpr double kRateLeft = 80.0;
constexpr double kRateRight = 24.0;
constexpr double kRateSide = 460.0;
constexpr const char* kAsClaimed = "claimed = observed";

/// Claimed rates fall to the right, where evidence grows; observed ones fall downwards.
struct RateAxes {
  double top = 0.0;
  [[nodiscard]] Point2 at(double claimed, double observed) const {
    return {kRateLeft + kRateSide * part(claimed), top + kRateSide * part(observed)};
  }
  /// 0 at a rate of 1, 1 at the least one.
  static double part(double rate) {
    ADIT_CHECK(rate > 0.0, "a logarithmic axis has no place for a rate of 0");
    return std::clamp(std::log(rate) / std::log(kLeastRate), 0.0, 1.0);
  }
};

void draw_rate_axes(SvgCanvas& canvas, const RateAxes& axes) {
  for (const double rate : log_ticks(kLeastRate, 1.0)) {
    canvas.line(axes.at(rate, 1.0), axes.at(rate, kLeastRate), {kGrid});
    canvas.line(axes.at(1.0, rate), axes.at(kLeastRate, rate), {kGrid});
    canvas.text(axes.at(rate, kLeastRate) + Point2(0.0, 20.0), tick_text(rate),
                {kMutedInk, 12.0, Anchor::middle});
    canvas.text(axes.at(1.0, rate) + Point2(-8.0, 4.0), tick_text(rate), {kMutedInk, 12.0, Anchor::end});
  }
  canvas.line(axes.at(1.0, 1.0), axes.at(kLeastRate, kLeastRate), {kMutedInk, 1.5, 1.0, Dash::dashes});
  const Point2 corner = axes.at(1.0, 1.0);
  canvas.text(corner + kRateSide * Point2(0.97, 0.25), "more wrong than claimed",
              {kMutedInk, 12.0, Anchor::end});
  canvas.text(corner + kRateSide * Point2(0.03, 0.8), "fewer wrong than claimed", {kMutedInk, 12.0});
  canvas.text(corner + kRateSide * Point2(0.5, 1.0) + Point2(0.0, 44.0),
              "claimed rate of wrong acceptance, exp(-evidence); log scale", {kInk, 13.0, Anchor::middle});
  canvas.text({20.0, axes.top + 0.5 * kRateSide}, "observed share that reaches it, 1 is all; log scale",
              {kInk, 13.0, Anchor::middle, 400, 0.0, -90.0});
}

/// The text stands on the side with more room.
void draw_rate_in_use(SvgCanvas& canvas, const RateAxes& axes, double rate) {
  if (!(rate <= 1.0 && rate >= kLeastRate)) return;
  const Point2 foot = axes.at(rate, kLeastRate);
  canvas.line(axes.at(rate, 1.0), foot, {kInk, 1.5, 1.0, Dash::dots});
  const bool is_left = RateAxes::part(rate) > 0.5;
  canvas.text(foot + Point2(is_left ? -8.0 : 8.0, -10.0), format("error rate in use: {:.2g}", rate),
              {kInk, 12.0, is_left ? Anchor::end : Anchor::start, 400, 4.0});
}

}  // namespace

std::string plot_rates(const RateFigure& figure) {
  SvgCanvas canvas(kRateLeft + kRateSide + kRateRight);
  canvas.text({20.0, 28.0}, figure.title, {.weight = 600});
  canvas.text({20.0, 48.0}, figure.note, {kMutedInk, 12.0});
  std::vector<LegendItem> legend;
  for (const RateCurve& curve : figure.curves)
    if (!curve.points.empty())
      legend.push_back({curve.label, curve.color, LegendItem::Mark::dash, curve.dash});
  legend.push_back({kAsClaimed, kMutedInk, LegendItem::Mark::dash, Dash::dashes});
  constexpr double kLegendTop = 60.0;
  const RateAxes axes{kLegendTop + draw_legend(canvas, {kRateLeft, kLegendTop}, kRateSide, legend) + 16.0};
  canvas.set_height(axes.top + kRateSide + 60.0);
  draw_rate_axes(canvas, axes);
  draw_rate_in_use(canvas, axes, figure.rate_in_use);
  for (const RateCurve& curve : figure.curves) {
    std::vector<Point2> line;
    for (const Eigen::Vector2d& point : curve.points) line.push_back(axes.at(point.x(), point.y()));
    canvas.polyline(line, {curve.color, 2.0, 1.0, curve.dash});
  }
  const Point2 middle = axes.at(1.0, 1.0) + 0.5 * Point2(kRateSide, kRateSide);
  if (!figure.absent.empty())
    canvas.text(middle, figure.absent, {.anchor = Anchor::middle, .weight = 600, .halo = 6.0});
  return canvas.document();
}

}  // namespace adit

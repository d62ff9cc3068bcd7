// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/reliability_plot.hpp"

#include "adit/core/format.hpp"
#include "adit/report/palette.hpp"
#include "adit/report/svg.hpp"

namespace adit {
namespace {

constexpr double kLeft = 72.0;
constexpr double kRight = 24.0;
constexpr double kSide = 420.0;

struct Axes {
  double top = 0.0;
  [[nodiscard]] Point2 at(const Eigen::Vector2d& share) const {
    return {kLeft + kSide * share.x(), top + kSide * (1.0 - share.y())};
  }
};

void draw_axes(SvgCanvas& canvas, const Axes& axes) {
  for (int k = 0; k <= 5; ++k) {
    const double share = 0.2 * k;
    const std::string label = format("{:.0f} %", 100.0 * share);
    canvas.line(axes.at({share, 0.0}), axes.at({share, 1.0}), {kGrid});
    canvas.line(axes.at({0.0, share}), axes.at({1.0, share}), {kGrid});
    canvas.text(axes.at({share, 0.0}) + Point2(0.0, 20.0), label, {kMutedInk, 12.0, Anchor::middle});
    canvas.text(axes.at({0.0, share}) + Point2(-8.0, 4.0), label, {kMutedInk, 12.0, Anchor::end});
  }
  canvas.line(axes.at({0.0, 0.0}), axes.at({1.0, 1.0}), {kMutedInk, 1.5, 1.0, Dash::dashes});
  canvas.text(axes.at({0.03, 0.95}), "too cautious", {kMutedInk, 12.0});
  canvas.text(axes.at({0.97, 0.04}), "too confident", {kMutedInk, 12.0, Anchor::end});
  canvas.text(axes.at({0.5, 0.0}) + Point2(0.0, 44.0), "share that the covariances claim",
              {kInk, 13.0, Anchor::middle});
  canvas.text({18.0, axes.top + 0.5 * kSide}, "share of the errors within",
              {kInk, 13.0, Anchor::middle, 400, 0.0, -90.0});
}

}  // namespace

std::string plot_reliability(std::span<const ReliabilityCurve> curves) {
  SvgCanvas canvas(kLeft + kSide + kRight);
  std::vector<LegendItem> legend;
  for (std::size_t i = 0; i < curves.size(); ++i)
    legend.push_back({curves[i].label, robot_color(i), LegendItem::Mark::dash});
  const double used = draw_legend(canvas, {kLeft, 22.0}, kSide, legend);
  const Axes axes{used + 34.0};
  canvas.set_height(axes.top + kSide + 60.0);
  draw_axes(canvas, axes);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    std::vector<Point2> line;
    for (const Eigen::Vector2d& point : curves[i].points) line.push_back(axes.at(point));
    canvas.polyline(line, {robot_color(i), 2.0});
  }
  return canvas.document();
}

}  // namespace adit

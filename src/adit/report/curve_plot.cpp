// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/curve_plot.hpp"

#include "adit/core/format.hpp"
#include "adit/report/palette.hpp"
#include "adit/report/svg.hpp"

namespace adit {
namespace {

constexpr double kCurveLeft = 72.0;
constexpr double kCurveRight = 24.0;
constexpr double kCurveWidth = 560.0;
constexpr double kCurveHeight = 320.0;

struct ShareAxes {
  double top = 0.0;
  double longest_x = 1.0;
  [[nodiscard]] Point2 at(double x, double share) const {
    return {kCurveLeft + kCurveWidth * x / longest_x, top + kCurveHeight * (1.0 - share)};
  }
};

void draw_share_axes(SvgCanvas& canvas, const ShareAxes& axes, const std::string& x_title,
                     const std::string& y_title) {
  constexpr int kParts = 4;
  for (int k = 0; k <= kParts; ++k) {
    const double part = static_cast<double>(k) / kParts;
    const double x = part * axes.longest_x;
    canvas.line(axes.at(x, 0.0), axes.at(x, 1.0), {kGrid});
    canvas.line(axes.at(0.0, part), axes.at(axes.longest_x, part), {kGrid});
    canvas.text(axes.at(x, 0.0) + Point2(0.0, 20.0), format("{:g}", x), {kMutedInk, 12.0, Anchor::middle});
    canvas.text(axes.at(0.0, part) + Point2(-8.0, 4.0), format("{:.0f} %", 100.0 * part),
                {kMutedInk, 12.0, Anchor::end});
  }
  canvas.text(axes.at(0.5 * axes.longest_x, 0.0) + Point2(0.0, 44.0), x_title, {kInk, 13.0, Anchor::middle});
  canvas.text({18.0, axes.top + 0.5 * kCurveHeight}, y_title, {kInk, 13.0, Anchor::middle, 400, 0.0, -90.0});
}

}  // namespace

std::string plot_shares(std::span<const ShareCurve> curves, double longest_x, const std::string& x_title,
                        const std::string& y_title) {
  SvgCanvas canvas(kCurveLeft + kCurveWidth + kCurveRight);
  std::vector<LegendItem> legend;
  for (std::size_t i = 0; i < curves.size(); ++i)
    legend.push_back({curves[i].label, robot_color(i), LegendItem::Mark::dash});
  const double used = draw_legend(canvas, {kCurveLeft, 22.0}, kCurveWidth, legend);
  const ShareAxes axes{used + 34.0, longest_x};
  canvas.set_height(axes.top + kCurveHeight + 60.0);
  draw_share_axes(canvas, axes, x_title, y_title);
  for (std::size_t i = 0; i < curves.size(); ++i) {
    std::vector<Point2> line;
    for (const Eigen::Vector2d& point : curves[i].points) line.push_back(axes.at(point.x(), point.y()));
    canvas.polyline(line, {robot_color(i), 2.0});
  }
  return canvas.document();
}

}  // namespace adit

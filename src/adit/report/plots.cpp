// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/plots.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/evaluation/statistics.hpp"
#include "adit/report/map_view.hpp"
#include "adit/report/palette.hpp"
#include "adit/report/svg.hpp"

namespace adit {
namespace {

std::vector<LegendItem> legend_of(std::span<const RobotPath> routes) {
  std::vector<LegendItem> items;
  for (const RobotPath& route : routes) items.push_back({route.name, robot_color(route.robot)});
  return items;
}

using LoopLines = std::vector<std::pair<Point2, Point2>>;

/// Loops of one class, in a merged map mostly shorter than a pixel: those are drawn as dots, on top of the
/// paths.
void draw_loops(SvgCanvas& canvas, const MapView& view, const GraphPicture& picture, LoopClass loop_class) {
  LoopLines lines;
  LoopLines dots;
  for (const PictureLoop& loop : picture.loops) {
    if (loop.loop_class != loop_class) continue;
    const Point2 a = view.at(loop.a);
    const Point2 b = view.at(loop.b);
    ((a - b).norm() < 5.0 ? dots : lines).emplace_back(a, b);
  }
  // Many loops lie over one another: thinner ink for more of them.
  const double opacity = std::clamp(150.0 / static_cast<double>(picture.loops.size() + 1), 0.5, 0.9);
  canvas.segments(lines, {loop_color(loop_class), 1.3, opacity});
  canvas.segments(dots, {loop_color(loop_class), 4.0});
}

std::vector<LegendItem> legend_of(const GraphPicture& picture, std::span<const RobotPath> robots) {
  std::vector<LegendItem> items = legend_of(robots);
  constexpr std::array<std::pair<LoopClass, const char*>, 3> kClasses = {
      {{LoopClass::correct, "correct"},
       {LoopClass::wrong_place, "wrong place"},
       {LoopClass::wrong_registration, "wrong registration"}}};
  for (const auto& [loop_class, label] : kClasses) {
    const auto count =
        std::count_if(picture.loops.begin(), picture.loops.end(),
                      [c = loop_class](const PictureLoop& loop) { return loop.loop_class == c; });
    items.push_back({format("{}: {}", label, count), loop_color(loop_class), LegendItem::Mark::dash});
  }
  return items;
}

/// The path in runs of one colour each.
void draw_colored_path(SvgCanvas& canvas, std::span<const Point2> points, std::span<const double> errors,
                       double largest) {
  constexpr double kSteps = 32.0;
  const auto step = [&](std::size_t i) {
    return std::floor(kSteps * 0.5 * (errors[i] + errors[i + 1]) / largest);
  };
  for (std::size_t first = 0; first + 1 < points.size();) {
    std::size_t last = first + 1;
    while (last + 1 < points.size() && step(last) == step(first)) ++last;
    canvas.polyline(points.subspan(first, last - first + 1),
                    {sequential_color((step(first) + 0.5) / kSteps), 4.0});
    first = last;
  }
}

void draw_color_bar(SvgCanvas& canvas, double bottom, double largest) {
  constexpr double kLength = 240.0;
  const Point2 corner(kFigureWidth - 16.0 - kLength, bottom + 12.0);
  constexpr int kSteps = 48;
  for (int i = 0; i < kSteps; ++i) {
    canvas.rectangle(corner + Point2(kLength * i / kSteps, 0.0), {kLength / kSteps + 0.6, 11.0},
                     sequential_color((i + 0.5) / kSteps));
  }
  for (const double tick : nice_ticks(0.0, largest, 4)) {
    const double x = corner.x() + kLength * tick / largest;
    canvas.line({x, corner.y() + 11.0}, {x, corner.y() + 15.0}, {kMutedInk, 1.0});
    canvas.text({x, corner.y() + 28.0}, tick_text(tick),
                {.color = kMutedInk, .size = 12.0, .anchor = Anchor::middle});
  }
  canvas.text(corner + Point2(-10.0, 10.0), "ATE (m)", {.color = kMutedInk, .anchor = Anchor::end});
}

/// The name above the dot, kept inside the figure.
void draw_labelled_start(SvgCanvas& canvas, const Point2& at, const std::string& name) {
  const double half = 0.5 * text_width(name, 13.0);
  const double x = std::clamp(at.x(), 16.0 + half, kFigureWidth - 16.0 - half);
  draw_start(canvas, at, kInk);
  canvas.text({x, at.y() - 12.0}, name, {.size = 13.0, .anchor = Anchor::middle, .weight = 600, .halo = 4.0});
}

// ---- boxplots

struct ValueAxis {
  double low = 0.0;
  double high = 1.0;
  enum class Scale { linear, logarithmic } scale = Scale::linear;
  double top = 0.0;
  double bottom = 0.0;

  [[nodiscard]] double at(double value) const {
    const bool log = scale == Scale::logarithmic;
    const double s =
        log ? std::log(std::max(value, low) / low) / std::log(high / low) : (value - low) / (high - low);
    return bottom - s * (bottom - top);
  }
  [[nodiscard]] std::vector<double> ticks() const {
    return scale == Scale::logarithmic ? log_ticks(low, high) : nice_ticks(low, high, 6);
  }
};

ValueAxis axis_for(std::span<const BoxGroup> groups) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0.0;
  for (const BoxGroup& group : groups) {
    for (const std::vector<double>& samples : group.samples) {
      if (samples.empty()) continue;
      const BoxStatistics box = box_statistics(samples);
      least = std::min(least, box.median);
      most = std::max(most, *std::max_element(samples.begin(), samples.end()));
    }
  }
  ValueAxis axis;
  if (most <= 0.0) return axis;
  axis.high = 1.12 * most;
  if (least > 0.0 && most > 30.0 * least) {
    axis.scale = ValueAxis::Scale::logarithmic;
    axis.low = round_down_nicely(std::max(0.2 * least, 1e-4 * most));
    axis.high = 1.6 * most;
  }
  return axis;
}

void draw_axis(SvgCanvas& canvas, const ValueAxis& axis, double left, const std::string& title) {
  for (const double tick : axis.ticks()) {
    const double y = axis.at(tick);
    canvas.line({left, y}, {kFigureWidth - 16.0, y}, {kGrid, 1.0});
    canvas.text({left - 8.0, y + 4.5}, tick_text(tick),
                {.color = kMutedInk, .size = 13.0, .anchor = Anchor::end});
  }
  const bool log = axis.scale == ValueAxis::Scale::logarithmic;
  canvas.text({18.0, 0.5 * (axis.top + axis.bottom)}, log ? title + ", log scale" : title,
              {.anchor = Anchor::middle, .turn_deg = -90.0});
}

/// At most this many outliers per box, evenly picked; the farthest is always among them.
constexpr std::size_t kMostOutliers = 40;

void draw_box(SvgCanvas& canvas, const ValueAxis& axis, double x, std::span<const double> samples,
              Rgba color) {
  constexpr double kHalf = 22.0;
  const BoxStatistics box = box_statistics(samples);
  const Stroke stroke = {color, 2.0};
  const auto y = [&](double value) { return axis.at(value); };
  canvas.line({x, y(box.lower_whisker)}, {x, y(box.lower_quartile)}, stroke);
  canvas.line({x, y(box.upper_quartile)}, {x, y(box.upper_whisker)}, stroke);
  for (const double whisker : {box.lower_whisker, box.upper_whisker}) {
    canvas.line({x - 0.5 * kHalf, y(whisker)}, {x + 0.5 * kHalf, y(whisker)}, stroke);
  }
  Rgba fill = color;
  fill.a = 60;
  const double height = std::max(1.0, y(box.lower_quartile) - y(box.upper_quartile));
  canvas.rectangle({x - kHalf, y(box.upper_quartile)}, {2.0 * kHalf, height}, fill, stroke);
  canvas.line({x - kHalf, y(box.median)}, {x + kHalf, y(box.median)}, {kInk, 2.5});
  const std::size_t stride = box.outliers.size() / kMostOutliers + 1;
  for (std::size_t i = 0; i < box.outliers.size(); i += stride) {
    Rgba faint = color;
    faint.a = 110;
    canvas.circle({x, y(box.outliers[box.outliers.size() - 1 - i])}, 2.5, faint);
  }
  const double largest = *std::max_element(samples.begin(), samples.end());
  canvas.text({x, y(largest) - 8.0}, format("{:.3g}", largest),
              {.color = kMutedInk, .size = 12.0, .anchor = Anchor::middle});
}

}  // namespace

std::string plot_routes(const FloorPlan& plan, std::span<const RobotPath> routes) {
  MapExtent extent;
  extent.extend(plan);
  for (const RobotPath& route : routes) extent.extend(route.path);
  SvgCanvas canvas(kFigureWidth);
  const MapView view = begin_map(canvas, extent.box(), legend_of(routes));
  draw_floor_plan(canvas, view, plan, kWall);
  for (std::size_t i = 0; i < routes.size(); ++i) {
    canvas.polyline(view.at(routes[i].path), {robot_color(routes[i].robot), path_width(i, routes.size())});
  }
  for (const RobotPath& route : routes) {
    if (!route.path.empty()) draw_start(canvas, view.at(route.path.front()), robot_color(route.robot));
  }
  draw_scale_bar(canvas, view);
  return canvas.document();
}

std::string plot_boxes(std::span<const std::string> methods, std::span<const BoxGroup> groups,
                       const std::string& axis_title) {
  constexpr double kLeft = 78.0;
  SvgCanvas canvas(kFigureWidth, 440.0);
  std::vector<LegendItem> legend;
  for (std::size_t m = 0; m < methods.size(); ++m) legend.push_back({methods[m], method_color(m)});
  const double used = draw_legend(canvas, {kLeft, 10.0}, kFigureWidth - kLeft, legend);
  ValueAxis axis = axis_for(groups);
  axis.top = used + 30.0;
  axis.bottom = 396.0;
  draw_axis(canvas, axis, kLeft, axis_title);
  canvas.line({kLeft, axis.bottom}, {kFigureWidth - 16.0, axis.bottom}, {kInk, 1.5});
  const double group_width =
      (kFigureWidth - 16.0 - kLeft) / static_cast<double>(std::max<std::size_t>(groups.size(), 1));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const double center = kLeft + (static_cast<double>(g) + 0.5) * group_width;
    const double pitch = std::min(64.0, group_width / static_cast<double>(methods.size() + 1));
    ADIT_CHECK(groups[g].samples.size() == methods.size(), "one list of samples per method");
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const double offset = static_cast<double>(m) - 0.5 * static_cast<double>(methods.size() - 1);
      const std::vector<double>& samples = groups[g].samples[m];
      if (!samples.empty()) draw_box(canvas, axis, center + offset * pitch, samples, method_color(m));
    }
    canvas.text({center, axis.bottom + 22.0}, groups[g].name, {.anchor = Anchor::middle});
  }
  return canvas.document();
}

std::string plot_graph(const GraphPicture& picture, std::span<const RobotPath> robots) {
  ADIT_CHECK(picture.robot_paths.size() == robots.size(), "one robot per path");
  MapExtent extent;
  for (const std::vector<Vector3>& path : picture.robot_paths) extent.extend(path);
  SvgCanvas canvas(kFigureWidth);
  const MapView view = begin_map(canvas, extent.box(), legend_of(picture, robots));
  for (std::size_t i = 0; i < robots.size(); ++i) {
    canvas.polyline(view.at(picture.robot_paths[i]),
                    {robot_color(robots[i].robot), path_width(i, robots.size())});
  }
  for (const LoopClass loop_class :
       {LoopClass::correct, LoopClass::wrong_registration, LoopClass::wrong_place}) {
    draw_loops(canvas, view, picture, loop_class);
  }
  for (std::size_t i = 0; i < robots.size(); ++i) {
    if (picture.robot_paths[i].empty()) continue;
    draw_start(canvas, view.at(picture.robot_paths[i].front()), robot_color(robots[i].robot));
  }
  draw_scale_bar(canvas, view);
  return canvas.document();
}

std::string plot_error_paths(const FloorPlan& plan, std::span<const ErrorPath> paths) {
  MapExtent extent;
  extent.extend(plan);
  double largest = 0.0;
  std::string summary;
  for (const ErrorPath& path : paths) {
    ADIT_CHECK(path.path.size() == path.errors_m.size(), "one error per position");
    extent.extend(path.path);
    const double here =
        path.errors_m.empty() ? 0.0 : *std::max_element(path.errors_m.begin(), path.errors_m.end());
    summary += format("{}{}: at most {:.3g} m", summary.empty() ? "" : "   ·   ", path.name, here);
    largest = std::max(largest, here);
  }
  largest = std::max(largest, 1e-3);
  SvgCanvas canvas(kFigureWidth);
  canvas.text({16.0, 24.0}, summary);
  const MapView view(extent.box(), 38.0);
  canvas.set_height(view.bottom() + kMapFooter);
  Rgba walls = kWall;
  draw_floor_plan(canvas, view, plan, walls);
  for (const ErrorPath& path : paths) {
    const std::vector<Point2> points = view.at(path.path);
    canvas.polyline(points, {kWhite, 7.0, 0.8});
    draw_colored_path(canvas, points, path.errors_m, largest);
  }
  for (const ErrorPath& path : paths) {
    if (path.path.empty()) continue;
    draw_labelled_start(canvas, view.at(path.path.front()), path.name);
  }
  draw_scale_bar(canvas, view);
  draw_color_bar(canvas, view.bottom(), largest);
  return canvas.document();
}

std::string plot_merged_map(std::span<const RobotCloud> clouds) {
  MapExtent extent;
  std::vector<LegendItem> legend;
  for (const RobotCloud& cloud : clouds) {
    extent.extend(cloud.points);
    legend.push_back({cloud.name, robot_color(cloud.robot)});
  }
  SvgCanvas canvas(kFigureWidth);
  const MapView view = begin_map(canvas, extent.box(), legend);
  for (const RobotCloud& cloud : clouds) {
    draw_floor_plan(canvas, view, floor_plan_of(cloud.points, 0.6 / view.pixels_per_metre()),
                    robot_color(cloud.robot));
  }
  draw_scale_bar(canvas, view);
  return canvas.document();
}

}  // namespace adit

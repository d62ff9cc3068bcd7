// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/loop_plots.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/report/map_view.hpp"
#include "adit/report/palette.hpp"
#include "adit/report/svg.hpp"

namespace adit {
namespace {

// ---- maps side by side

struct PlacedMap {
  MapExtent extent;
  Vector3 shift = Vector3::Zero();
};

/// Fills rows from left to right; the whole is about as wide as high.
void place_side_by_side(std::vector<PlacedMap>& maps) {
  double area = 0.0;
  double widest = 0.0;
  for (const PlacedMap& map : maps) {
    area += map.extent.box().sizes().prod();
    widest = std::max(widest, map.extent.box().sizes().x());
  }
  constexpr double kWidthOverHeight = 1.6;
  const double row_width = std::max(widest, 1.1 * std::sqrt(kWidthOverHeight * area));
  const double gap = 0.03 * row_width;
  Point2 pen = Point2::Zero();
  double row_height = 0.0;
  for (PlacedMap& map : maps) {
    const Eigen::AlignedBox2d box = map.extent.box();
    if (pen.x() > 0.0 && pen.x() + box.sizes().x() > row_width) {
      pen = {0.0, pen.y() - row_height - gap};
      row_height = 0.0;
    }
    map.shift.head<2>() = pen - Point2(box.min().x(), box.max().y());
    pen.x() += box.sizes().x() + gap;
    row_height = std::max(row_height, box.sizes().y());
  }
}

std::vector<PlacedMap> placed(const LoopMap& map) {
  std::size_t num_maps = 0;
  for (const LoopMap::Robot& robot : map.robots) num_maps = std::max(num_maps, robot.map + 1);
  std::vector<PlacedMap> maps(num_maps);
  for (const LoopMap::Robot& robot : map.robots) maps[robot.map].extent.extend(robot.path);
  if (num_maps > 1) place_side_by_side(maps);
  return maps;
}

std::vector<Vector3> shifted(std::vector<Vector3> path, const Vector3& shift) {
  for (Vector3& p : path) p += shift;
  return path;
}

// ---- loops

struct FateStyle {
  LoopFate fate;
  const char* label;
  Dash dash;
};
/// In the order of drawing.
constexpr std::array<FateStyle, 3> kFates = {{{LoopFate::weak, "refused, weak along the tunnel", Dash::dots},
                                              {LoopFate::refused, "refused", Dash::dashes},
                                              {LoopFate::in_use, "in use", Dash::none}}};

constexpr Rgba kSlip = {240, 150, 20};

std::vector<LegendItem> legend_of(const LoopMap& map) {
  std::vector<LegendItem> items;
  std::size_t num_slips = 0;
  for (const LoopMap::Robot& robot : map.robots) num_slips += robot.slips.size();
  for (std::size_t i = 0; i < map.robots.size(); ++i) items.push_back({map.robots[i].name, robot_color(i)});
  std::for_each(kFates.rbegin(), kFates.rend(), [&](const FateStyle& style) {
    const auto count = std::ranges::count(map.loops, style.fate, &LoopMap::Loop::fate);
    items.push_back(
        {format("{}: {}", style.label, count), fate_color(style.fate), LegendItem::Mark::dash, style.dash});
  });
  if (num_slips > 0)
    items.push_back({format("wheels slipped: {}", num_slips), kSlip, LegendItem::Mark::dash});
  return items;
}

/// In a merged map most loops are shorter than a pixel: those are drawn as dots.
void draw_loops(SvgCanvas& canvas, const MapView& view, const LoopMap& map,
                const std::vector<PlacedMap>& maps, const FateStyle& style) {
  std::vector<std::pair<Point2, Point2>> lines;
  std::vector<std::pair<Point2, Point2>> dots;
  const auto at = [&](const LoopMap::End& end) {
    const LoopMap::Robot& robot = map.robots.at(end.robot);
    return view.at(Vector3(robot.path.at(end.index) + maps[robot.map].shift));
  };
  for (const LoopMap::Loop& loop : map.loops) {
    if (loop.fate != style.fate) continue;
    const Point2 a = at(loop.from);
    const Point2 b = at(loop.to);
    ((a - b).norm() < 5.0 ? dots : lines).emplace_back(a, b);
  }
  const double opacity = std::clamp(80.0 / static_cast<double>(map.loops.size() + 1), 0.45, 0.9);
  const double width = style.dash == Dash::dots ? 2.2 : 1.3;
  canvas.segments(lines, {fate_color(style.fate), width, opacity, style.dash});
  canvas.segments(dots, {fate_color(style.fate), 5.0});
}

// ---- hypotheses

struct HypothesisStyle {
  Rgba color;
  Dash dash;
};

HypothesisStyle style_of(std::size_t hypothesis, Rgba best) {
  constexpr std::array<HypothesisStyle, kHypothesesDrawn - 1> kOthers = {
      {{{214, 39, 40}, Dash::dashes}, {{31, 79, 216}, Dash::dots}, {{0, 120, 80}, Dash::dashes_and_dots}}};
  return hypothesis == 0 ? HypothesisStyle{best, Dash::none} : kOthers[hypothesis - 1];
}

std::string describe(std::size_t number, const MergePicture::Hypothesis& h, double needed) {
  return format("{}: {}, evidence {:.1f} ({:.1f} needed), scans differ at {} of {} places, {} loop{}", number,
                h.outcome, h.evidence, needed, h.places_differing, h.places_compared, h.loops.size(),
                h.loops.size() == 1 ? "" : "s");
}

void draw_number(SvgCanvas& canvas, const Point2& at, std::size_t number, Rgba color) {
  canvas.circle(at, 9.0, color, {kWhite, 2.0});
  canvas.text(at + Point2(0.0, 4.5), format("{}", number),
              {.color = kWhite, .size = 13.0, .anchor = Anchor::middle, .weight = 600});
}

}  // namespace

std::string plot_loop_map(const LoopMap& map) {
  const std::vector<PlacedMap> maps = placed(map);
  MapExtent extent;
  for (const PlacedMap& one : maps) {
    const Eigen::AlignedBox2d box = one.extent.box();
    for (const Point2& corner : {Point2(box.min()), Point2(box.max())})
      extent.extend(std::vector{Vector3(Vector3(corner.x(), corner.y(), 0.0) + one.shift)});
  }
  SvgCanvas canvas(kFigureWidth);
  const MapView view = begin_map(canvas, extent.box(), legend_of(map));
  for (const PlacedMap& one : maps) {
    if (maps.size() < 2) break;
    const Eigen::AlignedBox2d box = one.extent.box();
    const Point2 corner = view.at(Point2(box.min().x() + one.shift.x(), box.max().y() + one.shift.y()));
    canvas.rectangle(corner, view.pixels_per_metre() * box.sizes(), kWhite, {kGrid, 1.5});
  }
  for (std::size_t i = 0; i < map.robots.size(); ++i) {
    const LoopMap::Robot& robot = map.robots[i];
    for (const std::vector<Vector3>& slip : robot.slips)
      canvas.polyline(view.at(shifted(slip, maps[robot.map].shift)), {kSlip, 10.0, 0.6});
    canvas.polyline(view.at(shifted(robot.path, maps[robot.map].shift)),
                    {robot_color(i), path_width(i, map.robots.size())});
  }
  for (const FateStyle& style : kFates) draw_loops(canvas, view, map, maps, style);
  for (std::size_t i = 0; i < map.robots.size(); ++i) {
    const LoopMap::Robot& robot = map.robots[i];
    if (!robot.path.empty())
      draw_start(canvas, view.at(Vector3(robot.path.front() + maps[robot.map].shift)), robot_color(i));
  }
  draw_scale_bar(canvas, view);
  return canvas.document();
}

std::string plot_hypotheses(const MergePicture& merge, std::array<std::size_t, 2> robots) {
  const std::size_t num_drawn = std::min(merge.hypotheses.size(), kHypothesesDrawn);
  const std::span drawn = std::span(merge.hypotheses).first(num_drawn);
  MapExtent extent;
  extent.extend(merge.path);
  std::vector<LegendItem> legend = {{merge.robots[0], robot_color(robots[0])}};
  for (std::size_t h = 0; h < num_drawn; ++h) {
    extent.extend(drawn[h].path);
    const HypothesisStyle style = style_of(h, robot_color(robots[1]));
    legend.push_back({format("{}{}", h == 0 ? merge.robots[1] + " as hypothesis " : "",
                             describe(h + 1, drawn[h], merge.evidence_needed)),
                      style.color, LegendItem::Mark::dash, style.dash});
  }
  SvgCanvas canvas(kFigureWidth);
  const MapView view = begin_map(canvas, extent.box(), legend);
  canvas.polyline(view.at(merge.path), {robot_color(robots[0]), 8.0, 0.45});
  for (std::size_t h = num_drawn; h-- > 0;) {
    const HypothesisStyle style = style_of(h, robot_color(robots[1]));
    canvas.polyline(view.at(drawn[h].path), {style.color, 2.5, 1.0, style.dash});
    for (const Vector3& loop : drawn[h].loops) canvas.circle(view.at(loop), 3.5, style.color, {kWhite, 1.0});
  }
  if (!merge.path.empty()) draw_start(canvas, view.at(merge.path.front()), robot_color(robots[0]));
  std::vector<Point2> numbers;  // those that start at one place stand above one another
  for (std::size_t h = 0; h < num_drawn; ++h) {
    if (drawn[h].path.empty()) continue;
    Point2 at = view.at(drawn[h].path.front());
    const auto is_covered = [&] {
      return std::ranges::any_of(numbers, [&](const Point2& other) { return (other - at).norm() < 18.0; });
    };
    while (is_covered()) at.y() -= 19.0;
    numbers.push_back(at);
    draw_number(canvas, at, h + 1, style_of(h, robot_color(robots[1])).color);
  }
  draw_scale_bar(canvas, view);
  return canvas.document();
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/map_view.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/format.hpp"
#include "adit/report/palette.hpp"

namespace adit {
namespace {

constexpr double kMargin = 16.0;
constexpr double kLargestHeight = 640.0;

/// Cells joined in squares of `factor`, each as dark as its darkest member: thin walls must not fade.
FloorPlan coarsened(const FloorPlan& plan, int factor) {
  if (factor <= 1) return plan;
  FloorPlan coarse;
  coarse.origin = plan.origin;
  coarse.cell_m = plan.cell_m * factor;
  coarse.width = (plan.width + factor - 1) / factor;
  coarse.height = (plan.height + factor - 1) / factor;
  coarse.density.assign(static_cast<std::size_t>(coarse.width) * static_cast<std::size_t>(coarse.height),
                        0.0F);
  for (int row = 0; row < plan.height; ++row) {
    for (int column = 0; column < plan.width; ++column) {
      float& cell =
          coarse.density[static_cast<std::size_t>(row / factor) * static_cast<std::size_t>(coarse.width) +
                         static_cast<std::size_t>(column / factor)];
      cell = std::max(cell, plan.at(column, row));
    }
  }
  return coarse;
}

std::string png_of(const FloorPlan& plan, Rgba color) {
  std::vector<Rgba> pixels;
  pixels.reserve(plan.density.size());
  for (int row = plan.height - 1; row >= 0; --row) {  // a picture starts at its top, in the north
    for (int column = 0; column < plan.width; ++column) {
      // 32 steps of opacity compress far better than 256 and look the same.
      color.a = static_cast<std::uint8_t>(std::lround(31.0F * plan.at(column, row)) * 255 / 31);
      pixels.push_back(color.a == 0 ? Rgba{0, 0, 0, 0} : color);
    }
  }
  return png_from_pixels(pixels, plan.width, plan.height);
}

}  // namespace

void MapExtent::extend(std::span<const Vector3> path) {
  for (const Vector3& p : path) {
    if (p.allFinite()) box_.extend(Point2(p.head<2>()));
  }
}

void MapExtent::extend(std::span<const Eigen::Vector3f> points) {
  for (const Eigen::Vector3f& p : points) {
    if (p.allFinite()) box_.extend(Point2(p.head<2>().cast<double>()));
  }
}

void MapExtent::extend(const FloorPlan& plan) {
  if (plan.empty()) return;
  box_.extend(plan.origin);
  box_.extend(Point2(plan.origin + plan.cell_m * Point2(plan.width, plan.height)));
}

Eigen::AlignedBox2d MapExtent::box() const {
  const Point2 center = box_.isEmpty() ? Point2(Point2::Zero()) : Point2(box_.center());
  const Point2 size = box_.isEmpty() ? Point2(Point2::Zero()) : Point2(box_.sizes());
  const double margin = 0.03 * size.maxCoeff();
  const Point2 half = (0.5 * size + Point2::Constant(margin)).cwiseMax(1.0);
  return {center - half, center + half};
}

MapView::MapView(const Eigen::AlignedBox2d& world, double top) : world_(world) {
  const Point2 size = world.sizes();
  const double room = kFigureWidth - 2.0 * kMargin;
  scale_ = std::min(room / size.x(), kLargestHeight / size.y());
  left_ = kMargin + 0.5 * (room - scale_ * size.x());
  bottom_ = top + scale_ * size.y();
}

Point2 MapView::at(const Point2& p) const {
  return {left_ + scale_ * (p.x() - world_.min().x()), bottom_ - scale_ * (p.y() - world_.min().y())};
}

std::vector<Point2> MapView::at(std::span<const Vector3> path) const {
  std::vector<Point2> points;
  points.reserve(path.size());
  for (const Vector3& p : path) points.push_back(at(p));
  return points;
}

MapView begin_map(SvgCanvas& canvas, const Eigen::AlignedBox2d& world, std::span<const LegendItem> legend) {
  constexpr double kTop = 10.0;
  const double used = draw_legend(canvas, {kMargin, kTop}, kFigureWidth - 2.0 * kMargin, legend);
  const MapView view(world, kTop + used + 6.0);
  canvas.set_height(view.bottom() + kMapFooter);
  return view;
}

void draw_start(SvgCanvas& canvas, const Point2& at, Rgba color) {
  canvas.circle(at, 6.5, color, {kWhite, 2.0});
}

double path_width(std::size_t index, std::size_t count) {
  return 3.0 + 1.5 * static_cast<double>(count - 1 - index);
}

void draw_scale_bar(SvgCanvas& canvas, const MapView& view) {
  const double metres = round_down_nicely(0.25 * kFigureWidth / view.pixels_per_metre());
  const double length = metres * view.pixels_per_metre();
  const Point2 left(kMargin, view.bottom() + 22.0);
  const Point2 right = left + Point2(length, 0.0);
  const Stroke stroke = {kInk, 2.0};
  canvas.line(left, right, stroke);
  for (const Point2& end : {left, right}) canvas.line(end - Point2(0.0, 4.0), end + Point2(0.0, 4.0), stroke);
  canvas.text(right + Point2(9.0, 5.0), tick_text(metres) + " m", {.color = kMutedInk});
}

void draw_floor_plan(SvgCanvas& canvas, const MapView& view, const FloorPlan& plan, Rgba color) {
  if (plan.empty()) return;
  const double cells_per_pixel = 1.0 / (plan.cell_m * view.pixels_per_metre());
  FloorPlan drawn = coarsened(plan, static_cast<int>(cells_per_pixel / 2.0) + 1);
  const Point2 south_west = view.at(drawn.origin);
  const Point2 size = drawn.cell_m * view.pixels_per_metre() * Point2(drawn.width, drawn.height);
  canvas.image({south_west.x(), south_west.y() - size.y()}, size, png_of(drawn, color));
}

}  // namespace adit

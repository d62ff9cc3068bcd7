// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The frame of all figures seen from above: equal scale on both axes, north up, a scale bar, walls as a grey
/// raster.
#pragma once

#include <Eigen/Geometry>
#include <span>

#include "adit/core/pose.hpp"
#include "adit/evaluation/floor_plan.hpp"
#include "adit/report/svg.hpp"

namespace adit {

inline constexpr double kFigureWidth = 800.0;  ///< Pixels: of every map, and of the box plots.
inline constexpr double kMapFooter = 44.0;     ///< Pixels: room for the scale bar.

/// The smallest box around everything that a figure shows; `extend` skips what is not finite.
class MapExtent {
 public:
  /// Widens the box so that it holds these too, in plan: heights do not count. An empty plan changes nothing.
  ///@{
  void extend(std::span<const Vector3> path);
  void extend(std::span<const Eigen::Vector3f> points);
  void extend(const FloorPlan& plan);
  ///@}
  /// With a margin of 3 %, and at least 2 m on a side; around the origin when nothing was shown.
  [[nodiscard]] Eigen::AlignedBox2d box() const;

 private:
  Eigen::AlignedBox2d box_;
};

/// Maps world metres to pixels: the world's box fills the figure's width unless it would become higher than
/// 640 pixels.
class MapView {
 public:
  /// `top` is the room for legend and labels above the map, in pixels.
  MapView(const Eigen::AlignedBox2d& world, double top);

  /// From the world frame (metres, north up; heights do not count) to pixels, y down.
  ///@{
  [[nodiscard]] Point2 at(const Vector3& p) const { return at(Point2(p.head<2>())); }
  [[nodiscard]] Point2 at(const Point2& p) const;
  [[nodiscard]] std::vector<Point2> at(std::span<const Vector3> path) const;
  ///@}
  [[nodiscard]] double pixels_per_metre() const { return scale_; }  ///< The same along both axes.
  [[nodiscard]] double bottom() const { return bottom_; }           ///< Where the map ends, in pixels.

 private:
  Eigen::AlignedBox2d world_;
  double scale_ = 1.0;
  double left_ = 0.0;
  double bottom_ = 0.0;
};

/// Legend at the top, then the view under it, with room for the scale bar below.
MapView begin_map(SvgCanvas& canvas, const Eigen::AlignedBox2d& world, std::span<const LegendItem> legend);

/// A dot with a white rim, as at the start of a path. `at`: pixels.
void draw_start(SvgCanvas& canvas, const Point2& at, Rgba color);

/// Robots that share a tunnel hide one another: the earlier ones are drawn wider, so that a rim of each stays
/// visible.
[[nodiscard]] double path_width(std::size_t index, std::size_t count);

/// A bar of round length with its metres, below the map at the left.
void draw_scale_bar(SvgCanvas& canvas, const MapView& view);

/// The plan as a raster of one colour, its density the opacity; at most two raster cells per pixel.
void draw_floor_plan(SvgCanvas& canvas, const MapView& view, const FloorPlan& plan, Rgba color);

}  // namespace adit

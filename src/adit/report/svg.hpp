// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A small SVG writer: shapes in, one self-contained document out. Units are pixels, y down.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "adit/report/png.hpp"

namespace adit {

using Point2 = Eigen::Vector2d;

enum class Dash { none, dashes, dots, dashes_and_dots };

struct Stroke {
  Rgba color;
  double width = 1.0;
  double opacity = 1.0;
  Dash dash = Dash::none;
};

enum class Anchor { start, middle, end };

struct TextStyle {
  Rgba color = {31, 41, 51};
  double size = 14.0;
  Anchor anchor = Anchor::start;
  int weight = 400;       ///< As in CSS: 400 plain, 600 semi-bold.
  double halo = 0.0;      ///< White rim in pixels, for text over lines.
  double turn_deg = 0.0;  ///< About the anchor, clockwise.
};

class SvgCanvas {
 public:
  /// A white canvas. The height may be set at the end, when the room that the content needs is known.
  explicit SvgCanvas(double width, double height = 1.0);
  void set_height(double height);

  [[nodiscard]] double width() const { return width_; }
  [[nodiscard]] double height() const { return height_; }

  void line(const Point2& a, const Point2& b, const Stroke& stroke);
  /// Nothing for fewer than two points. Simplified to a tenth of a pixel.
  void polyline(std::span<const Point2> points, const Stroke& stroke);
  /// Many separate lines of one look, in one element.
  void segments(std::span<const std::pair<Point2, Point2>> lines, const Stroke& stroke);
  void circle(const Point2& center, double radius, Rgba fill, const Stroke& outline = {{255, 255, 255}, 0.0});
  void rectangle(const Point2& corner, const Point2& size, Rgba fill,
                 const Stroke& outline = {{255, 255, 255}, 0.0});
  void text(const Point2& at, std::string_view text, const TextStyle& style = {});
  /// A PNG, stretched over the rectangle.
  void image(const Point2& corner, const Point2& size, std::string_view png);

  [[nodiscard]] std::string document() const;

 private:
  double width_;
  double height_;
  std::string body_;
};

/// The line through a subset of the points, both ends included, that is at most `tolerance` from the others
/// (Douglas and Peucker, 1973).
[[nodiscard]] std::vector<Point2> simplified(std::span<const Point2> points, double tolerance);

/// The approximate width of the text, pixels: fonts differ from viewer to viewer.
[[nodiscard]] double text_width(std::string_view text, double size);

struct LegendItem {
  std::string label;
  Rgba color;
  enum class Mark { dot, dash } mark = Mark::dot;
  Dash dash = Dash::none;  ///< Of a dash.
};
/// Rows of items from `at` rightwards within `width`. Returns the height used.
double draw_legend(SvgCanvas& canvas, const Point2& at, double width, std::span<const LegendItem> items);

}  // namespace adit

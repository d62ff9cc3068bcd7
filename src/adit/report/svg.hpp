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

/// A point or a size of a figure, in pixels; in map_view.hpp also a point of the world in plan, in metres.
using Point2 = Eigen::Vector2d;

/// Pattern of a line.
enum class Dash {
  none,            ///< Solid.
  dashes,          ///< 8 pixels and their round ends, every 14.
  dots,            ///< As wide as the line, every 6 pixels.
  dashes_and_dots  ///< 12 pixels and their round ends, with a dot between two.
};

/// How a line is drawn.
struct Stroke {
  Rgba color;              ///< Its `a` does not count, `opacity` does.
  double width = 1.0;      ///< Pixels; an outline of width 0 is not drawn.
  double opacity = 1.0;    ///< 0 to 1.
  Dash dash = Dash::none;  ///< Lengths of dashes and gaps do not grow with the width.
};

/// Which part of a text lies at its point.
enum class Anchor { start, middle, end };

/// How a text is drawn.
struct TextStyle {
  Rgba color = {31, 41, 51};      ///< Opaque: its `a` does not count.
  double size = 14.0;             ///< Of the font, pixels.
  Anchor anchor = Anchor::start;  ///< Also what the text turns about.
  int weight = 400;               ///< As in CSS: 400 plain, 600 semi-bold.
  double halo = 0.0;              ///< Width of a white line, half of it behind the letters; pixels.
  double turn_deg = 0.0;          ///< About the anchor, clockwise.
};

/// A figure that is being drawn: later shapes cover earlier ones. Coordinates are rounded to tenths of a
/// pixel. Throws ContractViolation on one that is not finite.
class SvgCanvas {
 public:
  /// A white canvas. The height may be set at the end, when the room that the content needs is known.
  explicit SvgCanvas(double width, double height = 1.0);
  /// At least 1, else throws ContractViolation. Shapes stay where they are.
  void set_height(double height);

  /// Of the document, pixels.
  ///@{
  [[nodiscard]] double width() const { return width_; }
  [[nodiscard]] double height() const { return height_; }
  ///@}

  /// Straight. The ends of a dashed line are round, those of a solid one flat.
  void line(const Point2& a, const Point2& b, const Stroke& stroke);
  /// Nothing for fewer than two points. Simplified to a tenth of a pixel.
  void polyline(std::span<const Point2> points, const Stroke& stroke);
  /// Many separate lines of one look, in one element.
  void segments(std::span<const std::pair<Point2, Point2>> lines, const Stroke& stroke);
  /// Filled; the `a` of `fill` is its opacity. `corner` is the upper left one.
  ///@{
  void circle(const Point2& center, double radius, Rgba fill, const Stroke& outline = {{255, 255, 255}, 0.0});
  void rectangle(const Point2& corner, const Point2& size, Rgba fill,
                 const Stroke& outline = {{255, 255, 255}, 0.0});
  ///@}
  /// One line of plain text; what SVG would read as markup is escaped. `at` lies on the base line.
  void text(const Point2& at, std::string_view text, const TextStyle& style = {});
  /// A PNG, stretched over the rectangle.
  void image(const Point2& corner, const Point2& size, std::string_view png);

  /// The SVG of all shapes so far.
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

/// One entry of a legend: a mark and a text.
struct LegendItem {
  std::string label;  ///< Plain text, one line.
  Rgba color;         ///< Of the mark; the text is dark.
  /// A filled circle, or a piece of a line.
  enum class Mark { dot, dash } mark = Mark::dot;  ///< Stands before the text.
  Dash dash = Dash::none;                          ///< Of a dash.
};
/// Rows of items from `at` rightwards within `width`. Returns the height used.
double draw_legend(SvgCanvas& canvas, const Point2& at, double width, std::span<const LegendItem> items);

}  // namespace adit

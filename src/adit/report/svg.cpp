// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/svg.hpp"

#include <algorithm>
#include <cmath>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/report/markup.hpp"
#include "adit/report/palette.hpp"

namespace adit {
namespace {

/// Tenths of a pixel, without trailing zero: coordinates are most of a document.
std::string number(double value) {
  ADIT_CHECK(std::isfinite(value), "a figure was given a coordinate that is not finite");
  const double tenths = std::round(10.0 * value);
  return format("{:g}", tenths == 0.0 ? 0.0 : std::clamp(tenths / 10.0, -99999.0, 99999.0));
}

std::string pair(const Point2& p) { return format("{} {}", number(p.x()), number(p.y())); }

const char* pattern(Dash dash) {
  return dash == Dash::dashes ? "8 6" : dash == Dash::dots ? "0.1 6" : "12 5 0.1 5";
}

std::string stroke_attributes(const Stroke& stroke) {
  std::string text = format(R"( stroke="{}" stroke-width="{}")", hex(stroke.color), number(stroke.width));
  if (stroke.opacity < 1.0) text += format(R"( stroke-opacity="{:.2g}")", stroke.opacity);
  if (stroke.dash != Dash::none) text += format(R"( stroke-dasharray="{}")", pattern(stroke.dash));
  return text;
}

/// Fill, with a stroke only where it has a width.
std::string fill_attributes(Rgba fill, const Stroke& outline) {
  std::string text = format(R"( fill="{}")", hex(fill));
  if (fill.a < 255) text += format(R"( fill-opacity="{:.2g}")", fill.a / 255.0);
  return outline.width > 0.0 ? text + stroke_attributes(outline) : text;
}

double distance_to_segment(const Point2& p, const Point2& a, const Point2& b) {
  const Point2 ab = b - a;
  const double length2 = ab.squaredNorm();
  const double s = length2 > 0.0 ? std::clamp((p - a).dot(ab) / length2, 0.0, 1.0) : 0.0;
  return (p - a - s * ab).norm();
}

}  // namespace

std::vector<Point2> simplified(std::span<const Point2> points, double tolerance) {
  if (points.size() < 3) return {points.begin(), points.end()};
  std::vector<char> kept(points.size(), 0);
  kept.front() = kept.back() = 1;
  std::vector<std::pair<std::size_t, std::size_t>> open = {{0, points.size() - 1}};
  while (!open.empty()) {
    const auto [first, last] = open.back();
    open.pop_back();
    double furthest = tolerance;
    std::size_t split = 0;
    for (std::size_t i = first + 1; i < last; ++i) {
      const double distance = distance_to_segment(points[i], points[first], points[last]);
      if (distance > furthest) furthest = distance, split = i;
    }
    if (split == 0) continue;
    kept[split] = 1;
    open.emplace_back(first, split);
    open.emplace_back(split, last);
  }
  std::vector<Point2> line;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (kept[i] != 0) line.push_back(points[i]);
  }
  return line;
}

double text_width(std::string_view text, double size) {
  return 0.56 * size * static_cast<double>(num_characters(text));
}

SvgCanvas::SvgCanvas(double width, double height) : width_(width), height_(height) {
  ADIT_CHECK(width >= 1.0 && height >= 1.0, "a figure has a size");
}

void SvgCanvas::set_height(double height) {
  ADIT_CHECK(height >= 1.0, "a figure has a size");
  height_ = height;
}

void SvgCanvas::line(const Point2& a, const Point2& b, const Stroke& stroke) {
  const char* cap = stroke.dash == Dash::none ? "" : " stroke-linecap=\"round\"";  // a dot is a cap
  body_ += format("<path{} d=\"M{}L{}\"{}/>\n", cap, pair(a), pair(b), stroke_attributes(stroke));
}

void SvgCanvas::polyline(std::span<const Point2> points, const Stroke& stroke) {
  if (points.size() < 2) return;
  std::string path;
  for (const Point2& p : simplified(points, 0.1)) path += format("{}{}", path.empty() ? 'M' : 'L', pair(p));
  body_ += format("<path fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\" d=\"{}\"{}/>\n",
                  path, stroke_attributes(stroke));
}

void SvgCanvas::segments(std::span<const std::pair<Point2, Point2>> lines, const Stroke& stroke) {
  if (lines.empty()) return;
  std::string path;
  for (const auto& [a, b] : lines) path += format("M{}L{}", pair(a), pair(b));
  body_ += format("<path stroke-linecap=\"round\" d=\"{}\"{}/>\n", path, stroke_attributes(stroke));
}

void SvgCanvas::circle(const Point2& center, double radius, Rgba fill, const Stroke& outline) {
  body_ += format("<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}/>\n", number(center.x()), number(center.y()),
                  number(radius), fill_attributes(fill, outline));
}

void SvgCanvas::rectangle(const Point2& corner, const Point2& size, Rgba fill, const Stroke& outline) {
  body_ += format("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}/>\n", number(corner.x()),
                  number(corner.y()), number(size.x()), number(size.y()), fill_attributes(fill, outline));
}

void SvgCanvas::text(const Point2& at, std::string_view text, const TextStyle& style) {
  const char* anchor = style.anchor == Anchor::start ? "start"
                       : style.anchor == Anchor::end ? "end"
                                                     : "middle";
  std::string extra;
  if (style.weight != 400) extra += format(" font-weight=\"{}\"", style.weight);
  if (style.halo > 0.0) {
    extra +=
        format(" stroke=\"#ffffff\" stroke-width=\"{}\" stroke-linejoin=\"round\" paint-order=\"stroke\"",
               number(style.halo));
  }
  if (style.turn_deg != 0.0) extra += format(" transform=\"rotate({:g} {})\"", style.turn_deg, pair(at));
  body_ += format("<text x=\"{}\" y=\"{}\" font-size=\"{:g}\" fill=\"{}\" text-anchor=\"{}\"{}>{}</text>\n",
                  number(at.x()), number(at.y()), style.size, hex(style.color), anchor, extra, escaped(text));
}

void SvgCanvas::image(const Point2& corner, const Point2& size, std::string_view png) {
  body_ += format(
      "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" "
      "href=\"data:image/png;base64,{}\"/>\n",
      number(corner.x()), number(corner.y()), number(size.x()), number(size.y()), base64(png));
}

std::string SvgCanvas::document() const {
  return format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
      "font-family=\"'Source Sans 3','Segoe UI','Helvetica Neue',Arial,'DejaVu "
      "Sans',sans-serif\">\n"
      "<rect width=\"{0}\" height=\"{1}\" fill=\"#ffffff\"/>\n{2}</svg>\n",
      number(width_), number(height_), body_);
}

double draw_legend(SvgCanvas& canvas, const Point2& at, double width, std::span<const LegendItem> items) {
  constexpr double kRow = 22.0;
  constexpr double kMark = 28.0;
  Point2 pen(at.x(), at.y() + 0.5 * kRow);
  for (const LegendItem& item : items) {
    const double needed = kMark + text_width(item.label, 14.0) + 20.0;
    if (pen.x() > at.x() && pen.x() + needed - 20.0 > at.x() + width) pen = {at.x(), pen.y() + kRow};
    if (item.mark == LegendItem::Mark::dash) {
      const double length = item.dash == Dash::none ? 16.0 : 20.0;
      canvas.line(pen, pen + Point2(length, 0.0), {item.color, 3.0, 1.0, item.dash});
    } else {
      canvas.circle(pen + Point2(8.0, 0.0), 6.0, item.color);
    }
    canvas.text(pen + Point2(kMark, 5.0), item.label);
    pen.x() += needed;
  }
  return items.empty() ? 0.0 : pen.y() - at.y() + 0.5 * kRow;
}

}  // namespace adit

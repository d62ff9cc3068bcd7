// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/svg.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"
#include "adit/report/markup.hpp"
#include "adit/report/palette.hpp"

namespace adit {
namespace {

TEST(Markup, EscapesCharactersThatMarkupUses) {
  EXPECT_EQ(escaped("a<b> & \"c\" 'd'"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;d&#39;");
  EXPECT_EQ(escaped("zwölf ✓"), "zwölf ✓");
  EXPECT_EQ(escaped(std::string("a\0b\x1b", 4)), "a?b?");
  EXPECT_EQ(escaped("\xff\xc3"), "??");       // not UTF-8
  EXPECT_EQ(escaped("\xed\xa0\x80"), "???");  // a lone surrogate
  EXPECT_EQ(escaped("\xc0\xbc"), "??");       // an overlong <
}

TEST(Markup, Base64OfTheStandardsExamples) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe\xfd"), "//79");
}

TEST(Svg, EveryShapeRendersAndTextIsEscaped) {
  SvgCanvas canvas(100.0, 50.0);
  canvas.line({0, 0}, {10, 10}, {kInk, 2.0});
  canvas.polyline(std::vector<Point2>{{0, 0}, {5, 9}, {20, 3}}, {kInk, 2.0, 0.5});
  canvas.polyline(std::vector<Point2>{{0, 0}}, {kInk});
  canvas.segments({}, {kInk});
  canvas.circle({5, 5}, 2.0, kWall, {kWhite, 1.0});
  canvas.text({1, 1}, "a < b & \x01", {.anchor = Anchor::end, .weight = 600, .halo = 2.0, .turn_deg = -90.0});
  canvas.image({0, 0}, {10, 10}, png_from_pixels(std::vector<Rgba>(4), 2, 2));
  draw_legend(canvas, {0, 0}, 60.0,
              std::vector<LegendItem>{{"one", kInk}, {"two two two", kWall, LegendItem::Mark::dash}});
  const std::string svg = canvas.document();
  EXPECT_NE(svg.find("a &lt; b &amp; ?"), std::string::npos);
  EXPECT_TRUE(png_from_svg(svg, 200)) << png_from_svg(svg, 200).error().message;
}

TEST(Svg, NumbersThatAreNotFiniteAreABug) {
  SvgCanvas canvas(100.0, 50.0);
  EXPECT_THROW(canvas.line({0, 0}, {std::nan(""), 0}, {kInk}), ContractViolation);
  EXPECT_THROW(SvgCanvas(0.0), ContractViolation);
}

double distance_to_line(const Point2& p, const std::vector<Point2>& line) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Point2 ab = line[i + 1] - line[i];
    const double s = std::clamp((p - line[i]).dot(ab) / std::max(ab.squaredNorm(), 1e-300), 0.0, 1.0);
    least = std::min(least, (p - line[i] - s * ab).norm());
  }
  return least;
}

TEST(Svg, SimplifiedLinesStayWithinTheTolerance) {
  Rng rng(11);
  std::vector<Point2> points = {{0, 0}};
  for (int i = 0; i < 2000; ++i)
    points.push_back(points.back() + Point2(rng.uniform(-0.5, 1.0), rng.normal() * 0.3));
  const std::vector<Point2> line = simplified(points, 0.5);
  EXPECT_LT(line.size(), points.size() / 2);
  EXPECT_EQ(line.front(), points.front());
  EXPECT_EQ(line.back(), points.back());
  for (const Point2& p : points) EXPECT_LE(distance_to_line(p, line), 0.5 + 1e-12);
  EXPECT_EQ(simplified(std::vector<Point2>(9, Point2(1, 1)), 0.1).size(), 2U);
  EXPECT_TRUE(simplified({}, 0.1).empty());
}

TEST(Palette, TicksAreRoundAndInside) {
  EXPECT_EQ(nice_ticks(0.0, 10.0, 5), (std::vector<double>{0, 2, 4, 6, 8, 10}));
  EXPECT_EQ(log_ticks(0.01, 100.0), (std::vector<double>{0.01, 0.1, 1, 10, 100}));
  EXPECT_EQ(log_ticks(0.5, 8.0).size(), 4U);  // 0.5 1 2 5
  Rng rng(12);
  for (int i = 0; i < 300; ++i) {
    const double low = rng.uniform(-50.0, 50.0);
    const double high = low + std::pow(10.0, rng.uniform(-4.0, 5.0));
    const std::vector<double> ticks = nice_ticks(low, high, 5);
    EXPECT_GE(ticks.size(), 2U);
    EXPECT_LE(ticks.size(), 12U);
    EXPECT_GE(ticks.front(), low - 1e-6 * (high - low));
    EXPECT_LE(ticks.back(), high + 1e-6 * (high - low));
  }
  EXPECT_EQ(tick_text(nice_ticks(0.0, 1.0, 4).front()), "0");
  EXPECT_DOUBLE_EQ(round_down_nicely(0.3), 0.2);
  EXPECT_DOUBLE_EQ(round_down_nicely(1000.0), 1000.0);
  EXPECT_THROW((void)round_down_nicely(0.0), ContractViolation);
}

TEST(Palette, ErrorColoursRiseInLightness) {
  double before = -1.0;
  for (double s = 0.0; s <= 1.0; s += 0.02) {
    const Rgba c = sequential_color(s);
    const double lightness = 0.299 * c.r + 0.587 * c.g + 0.114 * c.b;
    EXPECT_GE(lightness, before - 0.5);
    before = lightness;
  }
  EXPECT_EQ(sequential_color(-3.0), sequential_color(0.0));
  EXPECT_EQ(sequential_color(9.0), sequential_color(1.0));
}

}  // namespace
}  // namespace adit

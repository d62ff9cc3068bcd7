// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/png.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "adit/core/check.hpp"

namespace adit {
namespace {

/// A big-endian number of the header chunk; width stands at byte 16, height at byte 20.
std::uint32_t header_number(const std::string& png, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = at; i < at + 4; ++i) value = (value << 8U) | static_cast<unsigned char>(png.at(i));
  return value;
}

constexpr const char* kSvg =
    "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"200\" height=\"50\" viewBox=\"0 0 200 50\"><rect "
    "width=\"10\" height=\"10\"/></svg>";

TEST(Png, HasSignatureAndTheShapeOfTheFigure) {
  const std::string png = png_from_svg(kSvg, 600).value();
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(header_number(png, 16), 600U);
  EXPECT_EQ(header_number(png, 20), 150U);
  EXPECT_EQ(png, png_from_svg(kSvg, 600).value());
}

TEST(Png, RefusesWhatIsNotAFigure) {
  EXPECT_FALSE(png_from_svg("", 100));
  EXPECT_FALSE(png_from_svg("<svg", 100));
  EXPECT_FALSE(png_from_svg("<html xmlns=\"http://www.w3.org/1999/xhtml\"></html>", 100));
  EXPECT_FALSE(png_from_svg("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"1\" height=\"9000\"/>", 1000));
  EXPECT_THROW((void)png_from_svg(kSvg, 0), ContractViolation);
}

TEST(Png, PixelsBecomeAPicture) {
  const std::vector<Rgba> pixels(6, Rgba{255, 0, 0, 128});
  const std::string png = png_from_pixels(pixels, 3, 2);
  EXPECT_EQ(header_number(png, 16), 3U);
  EXPECT_EQ(header_number(png, 20), 2U);
  EXPECT_THROW((void)png_from_pixels(pixels, 3, 3), ContractViolation);
  EXPECT_THROW((void)png_from_pixels({}, 0, 0), ContractViolation);
}

}  // namespace
}  // namespace adit

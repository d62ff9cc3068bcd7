// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Rendering to PNG. The one place that includes librsvg and cairo.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "adit/core/result.hpp"

namespace adit {

/// The bytes of a PNG of the SVG document, `width_px` wide (1 to 16384) and as high as its shape asks for.
/// Fails when the text is not SVG, or states no size.
[[nodiscard]] Result<std::string> png_from_svg(const std::string& svg, int width_px);

/// Straight (not premultiplied) colour, 8 bits per channel.
struct Rgba {
  std::uint8_t r = 0;    ///< Red.
  std::uint8_t g = 0;    ///< Green.
  std::uint8_t b = 0;    ///< Blue.
  std::uint8_t a = 255;  ///< Opacity; 0: nothing is seen.
  bool operator==(const Rgba&) const = default;
};

/// The bytes of a PNG of a raster, top row first; `pixels` holds width * height entries. Throws
/// ContractViolation when it does not, or when a side is not within 1 to 16384.
[[nodiscard]] std::string png_from_pixels(std::span<const Rgba> pixels, int width, int height);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/png.hpp"

#include <cairo.h>
#include <librsvg/rsvg.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"

namespace adit {
namespace {

constexpr int kLargestSide = 16384;

struct Deleter {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { cairo_destroy(context); }
  void operator()(RsvgHandle* handle) const { g_object_unref(handle); }
  void operator()(GError* error) const { g_error_free(error); }
};
using Surface = std::unique_ptr<cairo_surface_t, Deleter>;
using Context = std::unique_ptr<cairo_t, Deleter>;
using Document = std::unique_ptr<RsvgHandle, Deleter>;
using RsvgError = std::unique_ptr<GError, Deleter>;

Surface image_surface(int width, int height) {
  return Surface(cairo_image_surface_create(CAIRO_FORMAT_ARGB32, width, height));
}

cairo_status_t append_bytes(void* out, const unsigned char* data, unsigned int length) {
  static_cast<std::string*>(out)->append(reinterpret_cast<const char*>(data), length);
  return CAIRO_STATUS_SUCCESS;
}

Result<std::string> encoded(const Surface& surface) {
  std::string png;
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), append_bytes, &png);
  if (status != CAIRO_STATUS_SUCCESS)
    return fail(format("writing a PNG failed: {}", cairo_status_to_string(status)));
  return png;
}

std::string message_of(const RsvgError& error) { return error ? error->message : "unknown reason"; }

Result<Document> parsed(const std::string& svg) {
  GError* raw_error = nullptr;
  Document document(
      rsvg_handle_new_from_data(reinterpret_cast<const guint8*>(svg.data()), svg.size(), &raw_error));
  const RsvgError error(raw_error);
  if (!document) return fail("the figure is not valid SVG: " + message_of(error));
  return document;
}

Result<int> height_for(const Document& document, int width_px) {
  double width = 0.0;
  double height = 0.0;
  if (rsvg_handle_get_intrinsic_size_in_pixels(document.get(), &width, &height) == 0 || width <= 0.0 ||
      height <= 0.0) {
    return fail("the figure states no size: give its svg element a width and a height in pixels");
  }
  const double height_px = std::max(1.0, std::round(height / width * width_px));
  if (height_px > kLargestSide)
    return fail(format("the picture would be {:.0f} pixels high; ask for a smaller width", height_px));
  return static_cast<int>(height_px);
}

/// Cairo's pixel: alpha in the top byte, colours multiplied by it.
std::uint32_t premultiplied(Rgba p) {
  const auto scaled = [&](std::uint32_t channel) { return (channel * p.a + 127U) / 255U; };
  return (static_cast<std::uint32_t>(p.a) << 24U) | (scaled(p.r) << 16U) | (scaled(p.g) << 8U) | scaled(p.b);
}

}  // namespace

Result<std::string> png_from_svg(const std::string& svg, int width_px) {
  ADIT_CHECK(width_px >= 1 && width_px <= kLargestSide, "a picture is between 1 and 16384 pixels wide");
  throw_if_cancelled();  // a picture takes a tenth of a second
  const Result<Document> document = parsed(svg);
  if (!document) return tl::unexpected(document.error());
  const Result<int> height_px = height_for(*document, width_px);
  if (!height_px) return tl::unexpected(height_px.error());
  const Surface surface = image_surface(width_px, *height_px);
  const Context context(cairo_create(surface.get()));
  const RsvgRectangle viewport = {0.0, 0.0, static_cast<double>(width_px), static_cast<double>(*height_px)};
  GError* raw_error = nullptr;
  const gboolean drawn = rsvg_handle_render_document(document->get(), context.get(), &viewport, &raw_error);
  const RsvgError error(raw_error);
  if (drawn == 0) return fail("drawing the figure failed: " + message_of(error));
  return encoded(surface);
}

std::string png_from_pixels(std::span<const Rgba> pixels, int width, int height) {
  ADIT_CHECK(width >= 1 && height >= 1 && width <= kLargestSide && height <= kLargestSide,
             "a picture's sides lie between 1 and 16384 pixels");
  ADIT_CHECK(pixels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
             "one colour per pixel");
  const Surface surface = image_surface(width, height);
  cairo_surface_flush(surface.get());
  unsigned char* data = cairo_image_surface_get_data(surface.get());
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface.get()));
  ADIT_CHECK(data != nullptr, "no memory for a picture");
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const std::size_t row = i / static_cast<std::size_t>(width);
    const std::size_t column = i % static_cast<std::size_t>(width);
    const std::uint32_t pixel = premultiplied(pixels[i]);
    std::memcpy(data + row * stride + 4 * column, &pixel, sizeof pixel);
  }
  cairo_surface_mark_dirty(surface.get());
  const Result<std::string> png = encoded(surface);
  ADIT_CHECK(png.has_value(), "a picture in memory can always be encoded");
  return *png;
}

}  // namespace adit

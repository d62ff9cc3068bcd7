// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/place/scan_context.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"

namespace adit {
namespace {

using Heights = Eigen::Map<const Eigen::ArrayXXf>;  // Rings x sectors; a sector is contiguous.

void check_config(ScanContextConfig config) {
  const Result<> valid = check_fields(fields_of(config));
  ADIT_CHECK(valid.has_value(), valid.error().message.c_str());
}

/// Angle of (x, y) in [0, 2 pi), to 2e-4 rad: a minimax polynomial of atan on [0, 1], folded out.
float rough_angle(float x, float y) {
  constexpr float kHalfPi = std::numbers::pi_v<float> / 2.0F;
  const float ax = std::abs(x);
  const float ay = std::abs(y);
  const float t = std::min(ax, ay) / std::max({ax, ay, std::numeric_limits<float>::min()});
  const float s = t * t;
  float angle = ((-0.0464964749F * s + 0.15931422F) * s - 0.327622764F) * s * t + t;
  angle = ay > ax ? kHalfPi - angle : angle;
  angle = x < 0.0F ? 2.0F * kHalfPi - angle : angle;
  return y < 0.0F ? 4.0F * kHalfPi - angle : angle;
}

/// Sector s holds the angles from s to s + 1 widths, counted from x to y. A rough angle names the sector or
/// one beside it; the sides of the two border rays decide. (An arc tangent a point would be two thirds of the
/// descriptor's cost.)
class Sectors {
 public:
  explicit Sectors(int num_sectors)
      : width_inverse_(static_cast<float>(num_sectors / (2.0 * std::numbers::pi))) {
    for (int s = 0; s <= num_sectors; ++s) {
      const double angle = 2.0 * std::numbers::pi * s / num_sectors;
      borders_.emplace_back(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)));
    }
  }

  [[nodiscard]] std::size_t of(float x, float y) const {
    const std::size_t last = borders_.size() - 2;
    const std::size_t guess = std::min(static_cast<std::size_t>(rough_angle(x, y) * width_inverse_), last);
    if (is_before(guess, x, y)) return guess == 0 ? last : guess - 1;
    if (!is_before(guess + 1, x, y)) return guess == last ? 0 : guess + 1;
    return guess;
  }

 private:
  [[nodiscard]] bool is_before(std::size_t border, float x, float y) const {
    return borders_[border].x() * y - borders_[border].y() * x < 0.0F;
  }

  float width_inverse_;
  std::vector<Eigen::Vector2f> borders_;
};

int positive_modulo(int a, int n) { return ((a % n) + n) % n; }

/// The dot product of `a` with `b` turned back by `shift` entries: sum of a[i] b[(i + shift) mod n].
float shifted_dot(const std::vector<float>& a, const std::vector<float>& b, std::size_t shift) {
  const auto n = static_cast<Eigen::Index>(a.size());
  const auto k = static_cast<Eigen::Index>(shift);
  const Eigen::Map<const Eigen::VectorXf> va(a.data(), n);
  const Eigen::Map<const Eigen::VectorXf> vb(b.data(), n);
  return va.head(n - k).dot(vb.tail(n - k)) + va.tail(k).dot(vb.head(k));
}

int num_shared_sectors(const ScanContext& query, const ScanContext& match, std::size_t shift) {
  const std::size_t n = query.norms.size();
  const auto seen = [&](std::size_t q, std::size_t m) {
    return query.norms[q] > 0.0F && match.norms[m] > 0.0F ? 1 : 0;
  };
  int shared = 0;
  for (std::size_t s = 0; s + shift < n; ++s) shared += seen(s, s + shift);
  for (std::size_t s = n - shift; s < n; ++s) shared += seen(s, s + shift - n);
  return shared;
}

/// Equations 5 and 6: because the columns have unit length, the cosines of all sectors together are one dot
/// product.
double distance_at(const ScanContext& query, const ScanContext& match, int shift) {
  const auto sectors = static_cast<std::size_t>(shift);
  const int shared = num_shared_sectors(query, match, sectors);
  if (shared == 0) return 1.0;
  const auto cells = sectors * static_cast<std::size_t>(query.num_rings);
  const double cosines = shifted_dot(query.unit_columns, match.unit_columns, cells);
  return std::clamp(1.0 - cosines / shared, 0.0, 1.0);
}

/// The shift at which the sector keys are nearest: their norms do not change, so it is where their product is
/// greatest.
int aligned_shift(const ScanContext& query, const ScanContext& match) {
  int best = 0;
  float greatest = -1.0F;
  for (int shift = 0; shift < query.num_sectors; ++shift) {
    const float product = shifted_dot(query.sector_key, match.sector_key, static_cast<std::size_t>(shift));
    if (product > greatest) {
      greatest = product;
      best = shift;
    }
  }
  return best;
}

ContextMatch best_around(const ScanContext& query, const ScanContext& match, int center, int reach) {
  ContextMatch best{2.0, 0, 0.0};
  for (int offset = -reach; offset <= reach; ++offset) {
    const int shift = positive_modulo(center + offset, query.num_sectors);
    const double distance = distance_at(query, match, shift);
    if (distance < best.distance || (distance == best.distance && shift < best.shift)) {
      best.distance = distance;
      best.shift = shift;
    }
  }
  best.yaw = wrap_angle(2.0 * std::numbers::pi * best.shift / query.num_sectors);
  return best;
}

void check_same_grid(const ScanContext& a, const ScanContext& b) {
  ADIT_CHECK(a.num_rings == b.num_rings && a.num_sectors == b.num_sectors,
             "contexts of one grid size are compared");
  ADIT_CHECK(a.num_sectors > 0, "a context is made by describe, from_heights or decode");
}

}  // namespace

Result<ScanContextConfig> scan_context_preset(std::string_view name) {
  if (name == "paper") return ScanContextConfig{};
  if (name == "tunnel") return ScanContextConfig{.max_radius_m = 30.0};
  return fail(format("no scan context preset '{}'; there are paper and tunnel", name));
}

float ScanContext::height(int ring, int sector) const {
  ADIT_CHECK(ring >= 0 && ring < num_rings && sector >= 0 && sector < num_sectors,
             "the cell lies in the grid");
  return Heights(unit_columns.data(), num_rings, num_sectors)(ring, sector) *
         norms[static_cast<std::size_t>(sector)];
}

bool ScanContext::empty() const {
  return std::ranges::all_of(norms, [](float norm) { return norm == 0.0F; });
}

ScanContext describe(const PointCloud& cloud_base, const ScanContextConfig& config) {
  check_config(config);
  const Sectors sectors(config.num_sectors);
  const auto num_rings = static_cast<std::size_t>(config.num_rings);
  const auto max_radius = static_cast<float>(config.max_radius_m);
  const auto offset = static_cast<float>(config.height_offset_m);
  const float rings_per_metre = static_cast<float>(config.num_rings) / max_radius;
  std::vector<float> heights(num_rings * static_cast<std::size_t>(config.num_sectors), 0.0F);
  for (const Eigen::Vector3f& p : cloud_base.points) {
    const float radius = std::sqrt(p.x() * p.x() + p.y() * p.y());
    const float height = p.z() + offset;
    // Written so that NaN fails.
    if (!(radius <= max_radius && height > 0.0F && height <= std::numeric_limits<float>::max())) continue;
    const std::size_t ring = std::min(static_cast<std::size_t>(radius * rings_per_metre), num_rings - 1);
    float& cell = heights[sectors.of(p.x(), p.y()) * num_rings + ring];
    cell = std::max(cell, height);
  }
  return from_heights(config.num_rings, config.num_sectors, heights);
}

ScanContext from_heights(int num_rings, int num_sectors, std::span<const float> heights) {
  ADIT_CHECK(num_rings > 0 && num_sectors > 0, "a context has at least one ring and one sector");
  ADIT_CHECK(heights.size() == static_cast<std::size_t>(num_rings) * static_cast<std::size_t>(num_sectors),
             "one height a cell");
  const Heights cells(heights.data(), num_rings, num_sectors);
  ADIT_CHECK((cells >= 0.0F && cells <= std::numeric_limits<float>::max()).all(),
             "heights are finite and not negative");
  ScanContext context;
  context.num_rings = num_rings;
  context.num_sectors = num_sectors;
  context.unit_columns.assign(heights.begin(), heights.end());
  for (int s = 0; s < num_sectors; ++s) {
    const float norm = cells.col(s).matrix().stableNorm();
    context.norms.push_back(norm);
    context.sector_key.push_back(cells.col(s).mean());
    Eigen::Map<Eigen::ArrayXf> unit(context.unit_columns.data() + static_cast<std::ptrdiff_t>(s) * num_rings,
                                    num_rings);
    if (norm > 0.0F) unit /= norm;
  }
  for (int r = 0; r < num_rings; ++r) context.ring_key.push_back(cells.row(r).mean());
  return context;
}

ContextMatch compare(const ScanContext& query, const ScanContext& match) {
  check_same_grid(query, match);
  const int reach = static_cast<int>(std::lround(0.05 * query.num_sectors));
  return best_around(query, match, aligned_shift(query, match), reach);
}

ContextMatch compare_all_shifts(const ScanContext& query, const ScanContext& match) {
  check_same_grid(query, match);
  return best_around(query, match, query.num_sectors / 2, query.num_sectors / 2);
}

// Byte 0: rings; bytes 1 and 2: sectors, low byte first; bytes 3 to 6: greatest height in millimetres, low
// byte first; then one byte a cell. A seen cell never becomes 0, which means empty.
namespace {
constexpr std::size_t kHeaderBytes = 7;
constexpr float kLevels = 255.0F;
}  // namespace

std::vector<std::uint8_t> encode(const ScanContext& context) {
  const Heights units(context.unit_columns.data(), context.num_rings, context.num_sectors);
  const Eigen::Map<const Eigen::ArrayXf> norms(context.norms.data(), context.num_sectors);
  const Eigen::ArrayXXf heights = units.rowwise() * norms.transpose();
  const double greatest = heights.size() == 0 ? 0.0 : static_cast<double>(heights.maxCoeff());
  ADIT_CHECK(greatest < 4e6, "heights fit 32 bits of millimetres");
  const auto millimetres =
      static_cast<std::uint32_t>(greatest > 0.0 ? std::max(1.0, std::round(greatest * 1000.0)) : 0.0);
  const auto step = static_cast<float>(millimetres) * 1e-3F / kLevels;
  std::vector<std::uint8_t> bytes = {static_cast<std::uint8_t>(context.num_rings),
                                     static_cast<std::uint8_t>(context.num_sectors & 0xff),
                                     static_cast<std::uint8_t>(context.num_sectors >> 8)};
  for (unsigned shift = 0; shift < 32; shift += 8)
    bytes.push_back(static_cast<std::uint8_t>(millimetres >> shift));
  for (const float height : heights.reshaped()) {
    const float level = height > 0.0F ? std::clamp(std::round(height / step), 1.0F, kLevels) : 0.0F;
    bytes.push_back(static_cast<std::uint8_t>(level));
  }
  return bytes;
}

Result<ScanContext> decode(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kHeaderBytes)
    return fail(format("scan context: {} bytes are less than its header", bytes.size()));
  const int num_rings = bytes[0];
  const int num_sectors = bytes[1] | (bytes[2] << 8);
  const auto num_cells = static_cast<std::size_t>(num_rings) * static_cast<std::size_t>(num_sectors);
  if (num_cells == 0 || bytes.size() != kHeaderBytes + num_cells) {
    return fail(
        format("scan context: {} bytes do not hold {} x {} cells", bytes.size(), num_rings, num_sectors));
  }
  std::uint32_t millimetres = 0;
  for (unsigned i = 0; i < 4; ++i) millimetres |= static_cast<std::uint32_t>(bytes[3 + i]) << (8 * i);
  const auto step = static_cast<float>(millimetres) * 1e-3F / kLevels;
  std::vector<float> heights;
  heights.reserve(num_cells);
  for (const std::uint8_t level : bytes.subspan(kHeaderBytes))
    heights.push_back(static_cast<float>(level) * step);
  return from_heights(num_rings, num_sectors, heights);
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/place/scan_context.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "adit/core/angles.hpp"
#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/core/simd.hpp"

namespace adit {
namespace {

using Heights = Eigen::Map<const Eigen::ArrayXXf>;  // Rings x sectors; a sector is contiguous.

void check_config(ScanContextConfig config) {
  const Result<> valid = check_fields(fields_of(config));
  ADIT_CHECK(valid.has_value(), valid.error().message.c_str());
}

/// Points that are sorted into cells together: their columns stay in the first-level cache.
constexpr std::size_t kChunk = 512;
/// Copies of the grid, each of which takes every fourth point: equal cells often follow each other, and no
/// maximum has to wait for the one before.
constexpr std::size_t kCopies = 4;

/// The polar grid in the numbers that the search for a point's cell needs.
class PolarGrid {
 public:
  explicit PolarGrid(const ScanContextConfig& config)
      : num_rings(config.num_rings),
        num_sectors(config.num_sectors),
        max_radius(static_cast<float>(config.max_radius_m)),
        rings_per_metre(static_cast<float>(config.num_rings) / max_radius),
        sectors_per_radian(static_cast<float>(config.num_sectors / (2.0 * std::numbers::pi))),
        height_offset(static_cast<float>(config.height_offset_m)) {
    for (int s = 0; s <= num_sectors; ++s) {
      const double angle = 2.0 * std::numbers::pi * s / num_sectors;
      borders_.emplace_back(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)));
    }
  }

  [[nodiscard]] int num_cells() const { return num_rings * num_sectors; }

  /// The cell beside the border between the sectors `guess` and the next one, on the side of (x, y).
  [[nodiscard]] int moved_to_its_side(int cell, float x, float y) const {
    const int guess = cell / num_rings;
    const int last = num_sectors - 1;
    int sector = guess;
    if (is_before(guess, x, y)) {
      sector = guess == 0 ? last : guess - 1;
    } else if (!is_before(guess + 1, x, y)) {
      sector = guess == last ? 0 : guess + 1;
    }
    return cell + (sector - guess) * num_rings;
  }

  const int num_rings;
  const int num_sectors;
  const float max_radius;
  const float rings_per_metre;
  const float sectors_per_radian;
  const float height_offset;

 private:
  [[nodiscard]] bool is_before(int border, float x, float y) const {
    const Eigen::Vector2f& b = borders_[static_cast<std::size_t>(border)];
    return b.x() * y - b.y() * x < 0.0F;
  }

  std::vector<Eigen::Vector2f> borders_;
};

/// Points, coordinate by coordinate, and what becomes of them.
struct Chunk {
  float x[kChunk];
  float y[kChunk];
  float height[kChunk];  ///< Above -height_offset_m; 0 where the point is left out.
  int cell[kChunk];      ///< Sector times number of rings plus ring; 0 where the point is left out.
  int is_on_border[kChunk];
};

/// Angles are found to 2e-4 rad by a minimax polynomial of atan on [0, 1], extended to the full turn. That
/// gives the sector of all points but those beside a border, which are decided later by the side they lie on:
/// an arc tangent per point would be two thirds of the descriptor's cost. No branches, so that the loop runs
/// in vector registers.
ADIT_WIDE_VECTORS void find_cells(const PolarGrid& grid, const Eigen::Vector3f* points, std::size_t n,
                                  Chunk& out) {
  constexpr float kHalfPi = std::numbers::pi_v<float> / 2.0F;
  constexpr float kAngleError = 1e-3F;
  const float max_radius = grid.max_radius;
  const float rings_per_metre = grid.rings_per_metre;
  const float sectors_per_radian = grid.sectors_per_radian;
  const float offset = grid.height_offset;
  const int num_rings = grid.num_rings;
  const float last_ring = static_cast<float>(num_rings - 1);
  const float last_sector = static_cast<float>(grid.num_sectors - 1);
  const float margin = kAngleError * sectors_per_radian;
  const float* coordinates = points->data();
  for (std::size_t k = 0; k < n; ++k) {
    const float x = coordinates[3 * k];
    const float y = coordinates[3 * k + 1];
    const float height = coordinates[3 * k + 2] + offset;
    const float radius = std::sqrt(x * x + y * y);
    const float ax = std::abs(x);
    const float ay = std::abs(y);
    const float shorter = ax < ay ? ax : ay;
    const float longer = ax < ay ? ay : ax;
    const float t = shorter / (longer > std::numeric_limits<float>::min() ? longer : 1.0F);
    const float u = t * t;
    float angle = ((-0.0464964749F * u + 0.15931422F) * u - 0.327622764F) * u * t + t;
    angle = ay > ax ? kHalfPi - angle : angle;
    angle = x < 0.0F ? 2.0F * kHalfPi - angle : angle;
    angle = y < 0.0F ? 4.0F * kHalfPi - angle : angle;
    const bool is_kept =  // written so that NaN fails
        radius <= max_radius && height > 0.0F && height <= std::numeric_limits<float>::max();
    const float at_sector = is_kept ? angle * sectors_per_radian : 0.0F;
    const float at_ring = is_kept ? radius * rings_per_metre : 0.0F;
    const int sector = static_cast<int>(at_sector < last_sector ? at_sector : last_sector);
    const int ring = static_cast<int>(at_ring < last_ring ? at_ring : last_ring);
    const float share = at_sector - static_cast<float>(sector);
    out.x[k] = x;
    out.y[k] = y;
    out.height[k] = is_kept ? height : 0.0F;
    out.cell[k] = sector * num_rings + ring;
    out.is_on_border[k] = is_kept && (share < margin || share > 1.0F - margin) ? 1 : 0;
  }
}

int positive_modulo(int a, int n) { return ((a % n) + n) % n; }

/// Sum of a[i] b[i]. Lane by lane, so that the order of additions does not depend on the machine.
ADIT_WIDE_VECTORS float dot(const float* a, const float* b, std::size_t n) {
  constexpr std::size_t kLanes = 8;
  constexpr std::size_t kSums = 4;  // none waits for the one before
  simd::Float8 sums[kSums] = {};
  std::size_t i = 0;
  for (; i + kSums * kLanes <= n; i += kSums * kLanes) {
    const simd::Float8* eights_a = reinterpret_cast<const simd::Float8*>(a + i);
    const simd::Float8* eights_b = reinterpret_cast<const simd::Float8*>(b + i);
    for (std::size_t s = 0; s < kSums; ++s) sums[s] += eights_a[s] * eights_b[s];
  }
  for (; i + kLanes <= n; i += kLanes)
    sums[0] += *reinterpret_cast<const simd::Float8*>(a + i) * *reinterpret_cast<const simd::Float8*>(b + i);
  const simd::Float8 lanes = (sums[0] + sums[1]) + (sums[2] + sums[3]);
  float sum = 0.0F;
  for (std::size_t l = 0; l < kLanes; ++l) sum += lanes[l];
  for (; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

/// The dot product of `a` with `b` turned back by `shift` entries: sum of a[i] b[(i + shift) mod n].
float shifted_dot(const std::vector<float>& a, const std::vector<float>& b, std::size_t shift) {
  const std::size_t n = a.size();
  return dot(a.data(), b.data() + shift, n - shift) + dot(a.data() + (n - shift), b.data(), shift);
}

/// The same for all shifts at once; `b_twice` is b, twice over.
ADIT_WIDE_VECTORS void add_shifted_dots(const float* a, const float* b_twice, std::size_t n,
                                        float* __restrict sums) {
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t shift = 0; shift < n; ++shift) sums[shift] += a[i] * b_twice[i + shift];
}

/// How many entries of both are above zero.
ADIT_WIDE_VECTORS int num_positive_in_both(const float* a, const float* b, std::size_t n) {
  int num = 0;
  for (std::size_t i = 0; i < n; ++i) num += static_cast<int>(a[i] > 0.0F) & static_cast<int>(b[i] > 0.0F);
  return num;
}

int num_shared_sectors(const ScanContext& query, const ScanContext& match, int shift) {
  const std::size_t n = query.norms.size();
  const auto turn = static_cast<std::size_t>(shift);
  const float* seen = query.norms.data();
  return num_positive_in_both(seen, match.norms.data() + turn, n - turn) +
         num_positive_in_both(seen + (n - turn), match.norms.data(), turn);
}

/// The shift at which the sector keys are nearest: their norms do not change, so it is where their product is
/// greatest.
int aligned_shift(const ScanContext& query, const ScanContext& match) {
  std::vector<float> twice = match.sector_key;
  twice.insert(twice.end(), match.sector_key.begin(), match.sector_key.end());
  std::vector<float> products(query.sector_key.size(), 0.0F);
  add_shifted_dots(query.sector_key.data(), twice.data(), products.size(), products.data());
  return static_cast<int>(std::ranges::max_element(products) - products.begin());
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
  best.yaw = yaw_of_shift(best.shift, query.num_sectors);
  return best;
}

PointCloud below_elevation(const PointCloud& cloud, const Vector3& viewpoint, double max_elevation_deg) {
  const auto slope = static_cast<float>(std::tan(max_elevation_deg * kDegree));
  PointCloud below;
  for (const Eigen::Vector3f& p : cloud.points) {
    const Eigen::Vector3f ray = p - viewpoint.cast<float>();
    if (ray.z() <= slope * ray.head<2>().norm()) below.points.push_back(p);
  }
  return below;
}

void check_same_grid(const ScanContext& a, const ScanContext& b) {
  ADIT_CHECK(a.num_rings == b.num_rings && a.num_sectors == b.num_sectors,
             "contexts of one grid size are compared");
  ADIT_CHECK(a.num_sectors > 0, "a context is made by describe, from_heights or decode");
}

}  // namespace

float ScanContext::height(int ring, int sector) const {
  ADIT_CHECK(ring >= 0 && ring < num_rings && sector >= 0 && sector < num_sectors,
             "the cell lies in the grid");
  return Heights(unit_columns.data(), num_rings, num_sectors)(ring, sector) *
         norms[static_cast<std::size_t>(sector)];
}

bool ScanContext::empty() const {
  return std::ranges::all_of(norms, [](float norm) { return norm == 0.0F; });
}

ScanContext describe(const PointCloud& cloud_base, const ScanContextConfig& config,
                     const Vector3& viewpoint) {
  check_config(config);
  if (config.max_elevation_deg < 90.0) {
    ScanContextConfig whole = config;
    whole.max_elevation_deg = 90.0;
    return describe(below_elevation(cloud_base, viewpoint, config.max_elevation_deg), whole);
  }
  const PolarGrid grid(config);
  const auto num_cells = static_cast<std::size_t>(grid.num_cells());
  std::vector<float> heights(kCopies * num_cells, 0.0F);
  Chunk chunk;
  for (std::size_t begin = 0; begin < cloud_base.size(); begin += kChunk) {
    const std::size_t n = std::min(kChunk, cloud_base.size() - begin);
    find_cells(grid, &cloud_base.points[begin], n, chunk);
    for (std::size_t k = 0; k < n; ++k) {
      int cell = chunk.cell[k];
      if (chunk.is_on_border[k] != 0) cell = grid.moved_to_its_side(cell, chunk.x[k], chunk.y[k]);
      float& highest = heights[k % kCopies * num_cells + static_cast<std::size_t>(cell)];
      highest = chunk.height[k] > highest ? chunk.height[k] : highest;
    }
  }
  for (std::size_t copy = 1; copy < kCopies; ++copy) {
    for (std::size_t c = 0; c < num_cells; ++c)
      heights[c] = std::max(heights[c], heights[copy * num_cells + c]);
  }
  heights.resize(num_cells);
  return from_heights(config.num_rings, config.num_sectors, heights);
}

ScanContext from_heights(int num_rings, int num_sectors, std::span<const float> heights) {
  ADIT_CHECK(num_rings > 0 && num_sectors > 0, "a context has at least one ring and one sector");
  ADIT_CHECK(heights.size() == static_cast<std::size_t>(num_rings) * static_cast<std::size_t>(num_sectors),
             "one height per cell");
  const Heights cells(heights.data(), num_rings, num_sectors);
  ADIT_CHECK((cells >= 0.0F && cells <= std::numeric_limits<float>::max()).all(),
             "heights are finite and not negative");
  ScanContext context;
  context.num_rings = num_rings;
  context.num_sectors = num_sectors;
  context.unit_columns.assign(heights.begin(), heights.end());
  for (int s = 0; s < num_sectors; ++s) {
    const auto norm = static_cast<float>(cells.col(s).cast<double>().matrix().norm());
    context.norms.push_back(norm);
    context.sector_key.push_back(cells.col(s).mean());
    Eigen::Map<Eigen::ArrayXf> unit(context.unit_columns.data() + static_cast<std::ptrdiff_t>(s) * num_rings,
                                    num_rings);
    if (norm > 0.0F) unit /= norm;
  }
  for (int r = 0; r < num_rings; ++r) context.ring_key.push_back(cells.row(r).mean());
  return context;
}

/// Equations 5 and 6: because the columns have unit length, the cosines of all sectors together are one dot
/// product.
double distance_at(const ScanContext& query, const ScanContext& match, int shift) {
  const int shared = num_shared_sectors(query, match, shift);
  if (shared == 0) return 1.0;
  const auto cells = static_cast<std::size_t>(shift) * static_cast<std::size_t>(query.num_rings);
  const double cosines = shifted_dot(query.unit_columns, match.unit_columns, cells);
  return std::clamp(1.0 - cosines / shared, 0.0, 1.0);
}

double yaw_of_shift(int shift, int num_sectors) {
  return wrap_angle(2.0 * std::numbers::pi * shift / num_sectors);
}

ContextMatch compare(const ScanContext& query, const ScanContext& match) {
  check_same_grid(query, match);
  const int reach = static_cast<int>(std::lround(0.05 * query.num_sectors));
  return best_around(query, match, aligned_shift(query, match), reach);
}

// Byte 0: rings; bytes 1 and 2: sectors, low byte first; bytes 3 to 6: greatest height in millimetres, low
// byte first; then one byte per cell. A seen cell never becomes 0, which means empty.
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

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/point_grid.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

#include "adit/core/check.hpp"
#include "adit/core/simd.hpp"

namespace adit {
namespace {

using simd::Float4;
using simd::Float8;
using simd::Int4;

constexpr std::size_t kLanes = 8;       ///< Points that are compared at once.
constexpr double kCellsPerPoint = 8.0;  ///< At most; each takes four bytes.

Float4 vector_of(const Eigen::Vector3f& v) { return Float4{v.x(), v.y(), v.z(), 0.0F}; }

/// Near first, then small index: a total order, so that every answer is unique.
bool closer(const Neighbor& a, const Neighbor& b) {
  return std::tie(a.squared_distance, a.index) < std::tie(b.squared_distance, b.index);
}

struct NearestVisitor {
  float bound;
  std::optional<Neighbor> best;
  void found(const Neighbor& n) {
    if (best && !closer(n, *best)) return;
    best = n;
    bound = n.squared_distance;
  }
};

struct NearestAloneVisitor {
  float bound;
  bool found_any = false;
  NearestAlone best{};
  void found(const Neighbor& n) {
    if (!found_any || closer(n, {best.index, best.squared_distance})) {
      if (found_any) bound = best.squared_distance;
      best.index = n.index;
      best.squared_distance = n.squared_distance;
      found_any = true;
    } else {
      bound = n.squared_distance;
    }
  }
};

}  // namespace

PointGrid::PointGrid(const std::vector<Eigen::Vector3f>& points, double cell_size) {
  ADIT_CHECK(cell_size > 0.0 && std::isfinite(cell_size), "a cell has a positive edge");
  Eigen::AlignedBox3f box;
  std::vector<std::uint32_t> finite;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) continue;
    box.extend(points[i]);
    finite.push_back(i);
  }
  if (finite.empty()) return;
  const Eigen::Vector3d sizes = box.max().cast<double>() - box.min().cast<double>();
  const double most_cells = kCellsPerPoint * static_cast<double>(finite.size());
  while ((sizes.array() / cell_size + 1.0).prod() > most_cells + 1.0) cell_size *= 2.0;
  cell_size_ = static_cast<float>(cell_size);
  cells_per_metre_ = 1.0F / cell_size_;
  low_ = vector_of(box.min());
  slack_ = 1e-6F * std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff());
  num_cells_ = __builtin_convertvector(cells_to(vector_of(box.max())), Int4) + 1;

  // Counting sort: the first place of each cell, then each point to the next place of its cell.
  const auto cell_of = [&](const Eigen::Vector3f& p) {
    const Int4 cell = __builtin_convertvector(cells_to(vector_of(p)), Int4);
    return row_of(cell[1], cell[2]) + static_cast<std::size_t>(cell[0]);
  };
  first_.assign(row_of(0, num_cells_[2]) + 1, 0);
  for (const std::uint32_t i : finite) ++first_[cell_of(points[i]) + 1];
  for (std::size_t cell = 1; cell < first_.size(); ++cell) first_[cell] += first_[cell - 1];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (std::vector<float>* column : {&x_, &y_, &z_})
    column->resize(finite.size() + kLanes - 1, std::numeric_limits<float>::quiet_NaN());
  index_.resize(finite.size());
  for (const std::uint32_t i : finite) {
    const std::uint32_t at = next[cell_of(points[i])]++;
    x_[at] = points[i].x();
    y_[at] = points[i].y();
    z_[at] = points[i].z();
    index_[at] = i;
  }
}

/// In cells from the corner of the box: monotonous in each coordinate, so that a point is never in a cell
/// beyond one of a farther point.
Float4 PointGrid::cells_to(Float4 position) const { return (position - low_) * cells_per_metre_; }

std::size_t PointGrid::row_of(int y, int z) const {
  return (static_cast<std::size_t>(z) * static_cast<std::size_t>(num_cells_[1]) +
          static_cast<std::size_t>(y)) *
         static_cast<std::size_t>(num_cells_[0]);
}

/// At least the distance of the farthest point.
float PointGrid::to_farthest(const Eigen::Vector3f& query) const {
  const Float4 q = vector_of(query);
  const Float4 high = low_ + cell_size_ * __builtin_convertvector(num_cells_, Float4);
  const Float4 away = simd::max(simd::max(q - low_, low_ - q), simd::max(q - high, high - q));
  return 1.001F * std::sqrt(away[0] * away[0] + away[1] * away[1] + away[2] * away[2]) + slack_;
}

/// Those of one cell or of cells side by side along x. Part of the searches that are compiled for wide
/// vectors, like `search`.
template <class Visitor>
[[gnu::always_inline]] inline void PointGrid::visit(std::uint32_t begin, std::uint32_t end,
                                                    const Eigen::Vector3f& query, Visitor& visitor) const {
  for (std::uint32_t i = begin; i < end; i += kLanes) {
    const Float8 dx = reinterpret_cast<const Float8&>(x_[i]) - query.x();
    const Float8 dy = reinterpret_cast<const Float8&>(y_[i]) - query.y();
    const Float8 dz = reinterpret_cast<const Float8&>(z_[i]) - query.z();
    const Float8 squared = dx * dx + dy * dy + dz * dz;
    if (!simd::any(squared <= visitor.bound)) continue;
    float distances[kLanes];
    std::memcpy(distances, &squared, sizeof(distances));
    const std::uint32_t num = std::min<std::uint32_t>(kLanes, end - i);
    for (std::uint32_t k = 0; k < num; ++k)
      if (distances[k] <= visitor.bound) visitor.found({index_[i + k], distances[k]});
  }
}

/// Those that hold every point whose squared distance is at most `bound`. Part of the searches that are
/// compiled for wide vectors.
[[gnu::always_inline]] inline PointGrid::CellRange PointGrid::cells_around(Float4 query, float bound) const {
  const Float4 num = __builtin_convertvector(num_cells_, Float4);
  const float reach = 1.0001F * std::sqrt(bound) + slack_;
  const Float4 low = cells_to(query - reach);
  const Float4 high = cells_to(query + reach);
  if (simd::any((low >= num) | (high < 0.0F))) return {};
  return {__builtin_convertvector(simd::max(low, Float4{}), Int4),
          __builtin_convertvector(simd::min(high, num - 1.0F), Int4)};
}

/// The cell of the query first: what is found there narrows the rest.
template <class Visitor>
[[gnu::always_inline]] inline void PointGrid::search(const Eigen::Vector3f& query, Visitor& visitor) const {
  const Float4 q = vector_of(query);
  const Float4 num = __builtin_convertvector(num_cells_, Float4);
  const Float4 at = cells_to(q);
  const bool is_inside = !simd::any((at < 0.0F) | (at >= num));
  Int4 own = {};
  if (is_inside) {
    own = __builtin_convertvector(at, Int4);
    const std::uint32_t* cell = &first_[row_of(own[1], own[2]) + static_cast<std::size_t>(own[0])];
    visit(cell[0], cell[1], query, visitor);
  }
  const auto [from, to] = cells_around(q, visitor.bound);
  for (int z = from[2]; z <= to[2]; ++z) {
    for (int y = from[1]; y <= to[1]; ++y) {
      const std::uint32_t* row = &first_[row_of(y, z)];
      if (is_inside && z == own[2] && y == own[1]) {
        visit(row[from[0]], row[own[0]], query, visitor);
        visit(row[own[0] + 1], row[to[0] + 1], query, visitor);
      } else {
        visit(row[from[0]], row[to[0] + 1], query, visitor);
      }
    }
  }
}

ADIT_WIDE_VECTORS std::optional<Neighbor> PointGrid::nearest(const Eigen::Vector3f& query,
                                                             float max_distance) const {
  if (index_.empty() || !query.allFinite()) return {};
  for (float reach = std::min(cell_size_, max_distance);; reach = std::min(2.0F * reach, max_distance)) {
    NearestVisitor visitor{reach * reach, {}};
    search(query, visitor);
    if (visitor.best || reach >= max_distance || reach > to_farthest(query)) return visitor.best;
  }
}

ADIT_WIDE_VECTORS std::optional<NearestAlone> PointGrid::nearest_alone(const Eigen::Vector3f& query,
                                                                       float bound) const {
  if (index_.empty() || !query.allFinite()) return {};
  NearestAloneVisitor visitor{.bound = bound};
  search(query, visitor);
  if (!visitor.found_any) return {};
  visitor.best.others_squared_distance = visitor.bound;
  return visitor.best;
}

/// Point by point, as the sums of `visit` are rounded in another order.
std::size_t PointGrid::num_nearer(const Eigen::Vector3f& query, float bound) const {
  if (index_.empty() || !query.allFinite() || !(bound > 0.0F)) return 0;
  const auto [from, to] = cells_around(vector_of(query), bound);
  std::size_t num = 0;
  for (int z = from[2]; z <= to[2]; ++z) {
    for (int y = from[1]; y <= to[1]; ++y) {
      const std::uint32_t* row = &first_[row_of(y, z)];
      for (std::uint32_t i = row[from[0]]; i < row[to[0] + 1]; ++i) {
        const Eigen::Vector3f point(x_[i], y_[i], z_[i]);
        num += (point - query).squaredNorm() < bound ? 1 : 0;
      }
    }
  }
  return num;
}

std::size_t PointGrid::num_bytes() const {
  return (x_.capacity() + y_.capacity() + z_.capacity()) * sizeof(float) +
         (index_.capacity() + first_.capacity()) * sizeof(std::uint32_t);
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/radius_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "adit/core/check.hpp"
#include "adit/core/simd.hpp"
#include "adit/geometry/voxel_grid.hpp"

namespace adit {
namespace {

struct Entry {
  VoxelKey cell;
  std::uint32_t index;
  auto operator<=>(const Entry&) const = default;
};

std::vector<Entry> entries_by_cell(const std::vector<Eigen::Vector3f>& points, float cell_size) {
  std::vector<VoxelKey> keys(points.size());
  VoxelGrid(cell_size).keys_of(points, keys);
  std::vector<Entry> entries(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) entries[i] = {keys[i], i};
  if (!std::ranges::is_sorted(entries)) std::ranges::sort(entries);
  return entries;
}

/// Coordinates side by side, for vector registers.
struct Columns {
  std::vector<float> x, y, z;
};

/// Positions in the sorted order.
struct Range {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

ADIT_WIDE_VECTORS void squared_distances(const float* x, const float* y, const float* z, std::size_t n,
                                         float px, float py, float pz, float* out) {
  for (std::size_t k = 0; k < n; ++k) {
    const float dx = x[k] - px;
    const float dy = y[k] - py;
    const float dz = z[k] - pz;
    out[k] = dx * dx + dy * dy + dz * dz;
  }
}

/// Searches cell after cell of the sorted points.
class CellSearch {
 public:
  CellSearch(const std::vector<Eigen::Vector3f>& points, float radius)
      : squared_radius_(radius * radius),
        entries_(entries_by_cell(points, radius * 1.0001F)) {  // rounding puts no neighbour two cells away
    for (std::vector<float>* column : {&sorted_.x, &sorted_.y, &sorted_.z}) column->reserve(points.size());
    for (const Entry& entry : entries_) {
      sorted_.x.push_back(points[entry.index].x());
      sorted_.y.push_back(points[entry.index].y());
      sorted_.z.push_back(points[entry.index].z());
    }
    found_.rows.resize(points.size());
  }

  NeighborPairs pairs() && {
    for (std::uint32_t begin = 0; begin < entries_.size() && entries_[begin].cell != VoxelKey::none();) {
      const VoxelKey cell = entries_[begin].cell;
      std::uint32_t end = begin + 1;
      while (end < entries_.size() && entries_[end].cell == cell) ++end;
      search_cell({begin, end});
      begin = end;
    }
    found_.neighbors.resize(num_found_);
    return std::move(found_);
  }

 private:
  std::uint32_t first_at_least(VoxelKey cell) const {
    const auto it = std::lower_bound(entries_.begin(), entries_.end(), Entry{cell, 0});
    return static_cast<std::uint32_t>(it - entries_.begin());
  }

  /// Three neighbours along x are one contiguous range; the rows with smaller (z, y) hold earlier points
  /// only, which have found this cell's points already.
  void search_cell(Range cell) {
    const VoxelKey key = entries_[cell.begin].cell;
    const std::array<VoxelKey, 5> rows = {key, key.shifted(0, 1, 0), key.shifted(0, -1, 1),
                                          key.shifted(0, 0, 1), key.shifted(0, 1, 1)};
    std::array<Range, 5> ranges;
    std::size_t num_candidates = 0;
    for (std::size_t c = 0; c < rows.size(); ++c) {
      ranges[c] = {first_at_least(rows[c].shifted(-1, 0, 0)), first_at_least(rows[c].shifted(2, 0, 0))};
      num_candidates += ranges[c].end - ranges[c].begin;
    }
    distances_.resize(std::max(distances_.size(), num_candidates));
    for (std::uint32_t k = cell.begin; k < cell.end; ++k) {
      const std::size_t room = num_found_ + num_candidates;
      if (found_.neighbors.size() < room) found_.neighbors.resize(2 * room);
      NeighborPairs::Row& row = found_.rows[entries_[k].index];
      row.begin = static_cast<std::uint32_t>(num_found_);
      for (const Range& range : ranges) append_near(k, {std::max(range.begin, k + 1), range.end});
      row.end = static_cast<std::uint32_t>(num_found_);
    }
  }

  /// Writes every candidate and keeps the near ones, because no processor can guess which are.
  void append_near(std::uint32_t k, Range range) {
    if (range.begin >= range.end) return;
    const std::size_t n = range.end - range.begin;
    squared_distances(&sorted_.x[range.begin], &sorted_.y[range.begin], &sorted_.z[range.begin], n,
                      sorted_.x[k], sorted_.y[k], sorted_.z[k], distances_.data());
    Neighbor* out = found_.neighbors.data() + num_found_;
    for (std::size_t c = 0; c < n; ++c) {
      *out = {entries_[range.begin + c].index, distances_[c]};
      out += distances_[c] <= squared_radius_ ? 1 : 0;
    }
    num_found_ = static_cast<std::size_t>(out - found_.neighbors.data());
  }

  float squared_radius_;
  std::vector<Entry> entries_;
  Columns sorted_;
  std::vector<float> distances_;
  NeighborPairs found_;
  std::size_t num_found_ = 0;
};

}  // namespace

NeighborPairs find_pairs_within(const std::vector<Eigen::Vector3f>& points, float radius) {
  ADIT_CHECK(radius > 0.0F && std::isfinite(radius), "a search radius is positive");
  return CellSearch(points, radius).pairs();
}

std::vector<std::uint32_t> order_by_cell(const std::vector<Eigen::Vector3f>& points, float cell_size) {
  std::vector<std::uint32_t> order;
  order.reserve(points.size());
  for (const Entry& entry : entries_by_cell(points, cell_size)) order.push_back(entry.index);
  return order;
}

}  // namespace adit

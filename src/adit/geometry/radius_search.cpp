// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/radius_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "adit/core/check.hpp"

namespace adit {
namespace {

constexpr float kMaxCell = 1.0e6F;
constexpr std::uint64_t kNoCell = std::numeric_limits<std::uint64_t>::max();

/// Cell coordinates in 21 bits each, x highest: keys in ascending order run along z first.
std::uint64_t cell_key(std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr std::int64_t kOffset = std::int64_t{1} << 20U;
  return (static_cast<std::uint64_t>(x + kOffset) << 42U) | (static_cast<std::uint64_t>(y + kOffset) << 21U) |
         static_cast<std::uint64_t>(z + kOffset);
}

std::uint64_t cell_of(const Eigen::Vector3f& point, float cell_size) {
  const Eigen::Array3f cell = (point / cell_size).array().floor();
  if (!(cell.abs() < kMaxCell).all()) return kNoCell;
  return cell_key(static_cast<std::int64_t>(cell.x()), static_cast<std::int64_t>(cell.y()),
                  static_cast<std::int64_t>(cell.z()));
}

struct Entry {
  std::uint64_t cell;
  std::uint32_t index;
  bool operator<(const Entry& other) const {
    return cell != other.cell ? cell < other.cell : index < other.index;
  }
};

struct Range {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
};

/// The points sorted by cell, and for the cell last asked for the sorted ranges that hold its later
/// neighbours.
class SortedCells {
 public:
  SortedCells(const std::vector<Eigen::Vector3f>& points, float cell_size) : position_(points.size(), 0) {
    entries_.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      entries_.push_back({cell_of(points[i], cell_size), static_cast<std::uint32_t>(i)});
    }
    std::sort(entries_.begin(), entries_.end());
    sorted_.reserve(points.size());
    for (std::size_t k = 0; k < entries_.size(); ++k) {
      sorted_.push_back(points[entries_[k].index]);
      position_[entries_[k].index] = static_cast<std::uint32_t>(k);
    }
  }

  /// Appends the neighbours of point i that lie after it in the sorted order: each pair is found from one
  /// side only.
  void append_later_neighbors(std::uint32_t i, float radius, std::vector<Neighbor>& out) {
    const std::uint32_t position = position_[i];
    const std::uint64_t cell = entries_[position].cell;
    if (cell == kNoCell) return;
    if (cell != current_cell_) enter_cell(cell);
    const Eigen::Vector3f point = sorted_[position];
    for (const Range& range : ranges_) {
      for (std::uint32_t k = std::max(range.begin, position + 1); k < range.end; ++k) {
        const float squared_distance = (sorted_[k] - point).squaredNorm();
        if (squared_distance <= radius * radius) out.push_back({entries_[k].index, squared_distance});
      }
    }
  }

 private:
  std::uint32_t first_at_least(std::uint64_t cell) const {
    const auto it = std::lower_bound(entries_.begin(), entries_.end(), Entry{cell, 0});
    return static_cast<std::uint32_t>(it - entries_.begin());
  }

  /// Three neighbours along z are one contiguous range; the columns with smaller (x, y) hold earlier points
  /// only.
  void enter_cell(std::uint64_t cell) {
    constexpr std::uint64_t kStepX = std::uint64_t{1} << 42U;
    constexpr std::uint64_t kStepY = std::uint64_t{1} << 21U;
    const std::array<std::uint64_t, 5> columns = {cell, cell + kStepY, cell + kStepX - kStepY, cell + kStepX,
                                                  cell + kStepX + kStepY};
    for (std::size_t c = 0; c < columns.size(); ++c) {
      ranges_[c] = {first_at_least(columns[c] - 1), first_at_least(columns[c] + 2)};
    }
    current_cell_ = cell;
  }

  std::vector<Entry> entries_;
  std::vector<Eigen::Vector3f> sorted_;
  std::vector<std::uint32_t> position_;  ///< Of each point in the sorted order.
  std::array<Range, 5> ranges_;
  std::uint64_t current_cell_ = kNoCell;
};

}  // namespace

NeighborPairs find_pairs_within(const std::vector<Eigen::Vector3f>& points, float radius) {
  ADIT_CHECK(radius > 0.0F && std::isfinite(radius), "a search radius is positive");
  NeighborPairs pairs;
  if (points.empty()) return pairs;
  SortedCells cells(points, radius);
  pairs.row_begin.reserve(points.size() + 1);
  pairs.row_begin.push_back(0);
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    cells.append_later_neighbors(i, radius, pairs.neighbors);
    pairs.row_begin.push_back(static_cast<std::uint32_t>(pairs.neighbors.size()));
  }
  return pairs;
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/radius_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "adit/core/check.hpp"
#include "adit/geometry/voxel_grid.hpp"

namespace adit {
namespace {

constexpr VoxelKey kNoCell{std::numeric_limits<std::uint64_t>::max()};

struct Entry {
  VoxelKey cell;
  std::uint32_t index;
  auto operator<=>(const Entry&) const = default;
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
    const VoxelGrid grid(cell_size * 1.0001F);  // rounding must not put a neighbour two cells away
    entries_.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      entries_.push_back({grid.key_of(points[i]).value_or(kNoCell), static_cast<std::uint32_t>(i)});
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
    const VoxelKey cell = entries_[position].cell;
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
  std::uint32_t first_at_least(VoxelKey cell) const {
    const auto it = std::lower_bound(entries_.begin(), entries_.end(), Entry{cell, 0});
    return static_cast<std::uint32_t>(it - entries_.begin());
  }

  /// Three neighbours along x are one contiguous range; the rows with smaller (z, y) hold earlier points
  /// only.
  void enter_cell(VoxelKey cell) {
    const std::array<VoxelKey, 5> rows = {cell, cell.shifted(0, 1, 0), cell.shifted(0, -1, 1),
                                          cell.shifted(0, 0, 1), cell.shifted(0, 1, 1)};
    for (std::size_t c = 0; c < rows.size(); ++c) {
      ranges_[c] = {first_at_least(rows[c].shifted(-1, 0, 0)), first_at_least(rows[c].shifted(2, 0, 0))};
    }
    current_cell_ = cell;
  }

  std::vector<Entry> entries_;
  std::vector<Eigen::Vector3f> sorted_;
  std::vector<std::uint32_t> position_;  ///< Of each point in the sorted order.
  std::array<Range, 5> ranges_;
  VoxelKey current_cell_ = kNoCell;
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

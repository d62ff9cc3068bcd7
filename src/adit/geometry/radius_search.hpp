// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// All neighbours of all points within one fixed radius: the search that surface normals and local
/// descriptors need.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "adit/geometry/neighbor.hpp"

namespace adit {

/// Every pair of neighbours once, in compressed sparse rows: the row of a point holds those of its neighbours
/// that no earlier search found. Whatever is symmetric in a pair (a covariance, a pair feature) is thus
/// computed once for both.
struct NeighborPairs {
  /// A range of `neighbors`.
  struct Row {
    std::uint32_t begin = 0;  ///< Of the first.
    std::uint32_t end = 0;    ///< Behind the last.
  };
  std::vector<Row> rows;            ///< One per point; their ranges are in no order.
  std::vector<Neighbor> neighbors;  ///< Each pair once. Those of a row are side by side.

  /// As many as were searched, with neighbours or without.
  [[nodiscard]] std::size_t num_points() const { return rows.size(); }
  /// The neighbours of point `i` that stand in its own row; with others the pair stands in theirs.
  [[nodiscard]] std::span<const Neighbor> row(std::size_t i) const {
    return std::span(neighbors).subspan(rows[i].begin, rows[i].end - rows[i].begin);
  }
};

/// All pairs of different points no farther apart than `radius` metres. Points are sorted into cubic cells of
/// that edge, so that a search reads half of 27 cells. Points with a NaN, infinite or absurd coordinate
/// (beyond 10^6 radii from the origin) are in no pair. Throws ContractViolation unless radius > 0.
[[nodiscard]] NeighborPairs find_pairs_within(const std::vector<Eigen::Vector3f>& points, float radius);

/// The points' indices in the order of such cells: neighbours in space become neighbours in memory.
[[nodiscard]] std::vector<std::uint32_t> order_by_cell(const std::vector<Eigen::Vector3f>& points,
                                                       float cell_size);

}  // namespace adit

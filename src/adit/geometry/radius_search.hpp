// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// All neighbours of all points within one fixed radius, the search that surface normals and local
/// descriptors need.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "adit/geometry/kd_tree.hpp"

namespace adit {

/// The neighbours of every point, row after row (compressed sparse rows).
struct Neighborhoods {
  std::vector<std::uint32_t> row_begin;  ///< One a point, and the end of the last.
  std::vector<Neighbor> neighbors;

  [[nodiscard]] std::size_t size() const { return row_begin.empty() ? 0 : row_begin.size() - 1; }
  [[nodiscard]] std::span<const Neighbor> of(std::size_t i) const {
    return std::span(neighbors).subspan(row_begin[i], row_begin[i + 1] - row_begin[i]);
  }
};

/// For every point all *other* points no farther than `radius` metres, in ascending order of index. Points
/// are sorted into cubic cells of that edge, so that a search reads 27 cells. Points with a NaN or infinite
/// coordinate neither have nor are neighbours. Throws ContractViolation unless radius > 0.
[[nodiscard]] Neighborhoods radius_neighborhoods(const std::vector<Eigen::Vector3f>& points, float radius);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <compare>
#include <cstddef>
#include <span>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/geometry/triangle_mesh.hpp"

namespace adit {

/// A column of a grid in plan: its middle is at ((x + 0.5) cell, (y + 0.5) cell).
struct FloorColumn {
  int x = 0;  ///< Negative to the west of the origin.
  int y = 0;  ///< Negative to the south of it.
  auto operator<=>(const FloorColumn&) const = default;
};
/// The column that holds `p` in plan; columns are `cell` metres wide.
[[nodiscard]] FloorColumn column_of(const Vector3& p, double cell);

/// A surface that is not too steep, exactly above or below the middle of a column.
struct FloorSample {
  FloorColumn column;  ///< Of the grid that floor_samples() was asked for.
  double z = 0.0;      ///< Height of the surface there, metres.
};

/// Every such surface of the mesh, floors and ceilings alike, by column and from the lowest up: levels above
/// one another are samples of one column. Of surfaces less than 3 cm apart the highest remains. Steeper than
/// 60 degrees is a wall. The mesh must pass `check_mesh`.
[[nodiscard]] std::vector<FloorSample> floor_samples(const TriangleMesh& mesh, double cell);

/// The elements of one column, of a list that is sorted by their columns.
template <class Element>
[[nodiscard]] std::span<const Element> in_column(const std::vector<Element>& sorted, FloorColumn column) {
  return {std::ranges::lower_bound(sorted, column, {}, &Element::column),
          std::ranges::upper_bound(sorted, column, {}, &Element::column)};
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>

namespace adit {

/// A surface counts as mapped where a point of the map is so near, metres.
inline constexpr double kMappedWithin = 0.10;

/// How far a map is from the true surface, and how much of that it holds.
struct MapAccuracy {
  std::size_t num_points = 0;  ///< Of the map.
  double median_m = 0.0;       ///< Of the distances of all points of the map from the surface,
  double p95_m = 0.0;          ///< and their 95th percentile.
  /// Share, 0 to 1, of the surface that could have been seen that lies within `kMappedWithin` of the map;
  /// none where it is not known what could have been seen.
  std::optional<double> completeness;
  double seen_m2 = 0.0;  ///< Area of the surface that could have been seen.
};

}  // namespace adit

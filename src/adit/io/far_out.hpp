// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The bound of the coordinates in files.
#pragma once

#include <Eigen/Core>
#include <cmath>

#include "adit/core/format.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// Metres: beyond the earth and all its map grids. Between robots 1e7 m are the most (transport/wire.cpp), as
/// maps are in the frames of their odometries. Numbers without a bound may be finite each and overflow
/// when two poses are composed.
inline constexpr double kFarthestCoordinate = 1e9;

/// Fails, with the number and the remedy, where a coordinate of the position is farther out, or not a number.
template <class Position>
[[nodiscard]] Result<> check_not_far_out(const Position& position) {
  for (Eigen::Index i = 0; i < position.size(); ++i)
    if (!(std::abs(position[i]) <= kFarthestCoordinate))
      return fail(
          format("{} is not a coordinate in metres, which are {} at most; check the order of the numbers and "
                 "their unit",
                 position[i], kFarthestCoordinate));
  return {};
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/simulation/raycaster.hpp"

namespace adit {

/// What is around a part of the floor, as rays in all directions say.
struct Outlook {
  double escaping = 0.0;                  ///< Share of the rays that meet nothing,
  double facing = 0.0;                    ///< and of the others the share that meets the front of a triangle.
  std::vector<Vector3> openings;          ///< Places from which more than a tenth escapes.
  Vector3 widest_open = Vector3::Zero();  ///< The place from which most escape.
};

/// Looks around from `height` metres above at most 256 of the positions, spread evenly over them; at least
/// one.
[[nodiscard]] Outlook look_around(std::span<const Vector3> positions, double height,
                                  const Raycaster& raycaster);

}  // namespace adit

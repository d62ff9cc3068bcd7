// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>

#include "adit/core/pose.hpp"

namespace adit {

/// The squared distance of `p` from the triangle, square metres; one that is a line or a point counts as
/// such.
[[nodiscard]] double squared_distance_to_triangle(const Vector3& p, const std::array<Vector3, 3>& corners);

}  // namespace adit

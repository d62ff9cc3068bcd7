// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <numbers>

namespace adit {

/// One degree in radians.
inline constexpr double kDegree = std::numbers::pi / 180.0;

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

namespace adit {

/// Logarithm of the gamma function of x > 0. std::lgamma writes the sign into a global variable: a data race
/// where two threads call it.
[[nodiscard]] inline double log_gamma(double x) {
  int sign = 0;
  return ::lgamma_r(x, &sign);
}

}  // namespace adit

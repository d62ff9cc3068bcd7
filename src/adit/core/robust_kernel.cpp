// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/robust_kernel.hpp"

#include <algorithm>
#include <cmath>

namespace adit {

double tls_weight(double squared_residual, double squared_bound, double mu) {
  if (squared_residual <= mu / (mu + 1.0) * squared_bound) return 1.0;
  if (squared_residual >= (mu + 1.0) / mu * squared_bound) return 0.0;
  return std::clamp(std::sqrt(squared_bound * mu * (mu + 1.0) / squared_residual) - mu, 0.0, 1.0);
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Weights that robust costs give to residuals. Each is 1 for a residual of zero.
#pragma once

namespace adit {

/// The square root of the Geman-McClure weight (k / (k + r^2))^2, which is also k / (k + r^2) = 1 - rho / k
/// of its cost rho = k r^2 / (k + r^2). `scale` is k, in the squared unit of the residual.
template <class T>
[[nodiscard, gnu::always_inline]] inline T geman_mcclure_root(T scale, T squared_residual) {
  return scale / (scale + squared_residual);
}

/// The weight of truncated least squares under graduated non-convexity with control parameter `mu`: 1 up to
/// mu / (mu + 1) of the bound, 0 from (mu + 1) / mu of it on, and between them the closed form of Yang,
/// Antonante, Tzoumas and Carlone, "Graduated Non-Convexity for Robust Spatial Perception", RA-L 2020,
/// equation 14. `squared_bound` is in the unit of `squared_residual`; both and `mu` are positive.
[[nodiscard]] double tls_weight(double squared_residual, double squared_bound, double mu);

}  // namespace adit

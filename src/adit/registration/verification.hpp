// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The evidence for a registration, and the verdict on it.
#pragma once

#include <string>

#include "adit/core/pose.hpp"
#include "adit/geometry/point_grid.hpp"
#include "adit/registration/features.hpp"
#include "adit/registration/registration.hpp"
#include "adit/registration/registration_config.hpp"

namespace adit {

/// As the fields of the same names in Registration.
struct Evidence {
  double overlap = 0.0;                      ///< 0 to 1, the smaller of both directions.
  Matrix6 information = Matrix6::Zero();     ///< Zero where no pair of points agrees.
  double weak_axis = 0.0;                    ///< 0 to 1/3; below kWeakAxis the clouds are free to slide.
  Vector3 weak_direction = Vector3::Zero();  ///< In the frame of a; zero where no pair of points agrees.
};

/// Overlap in both directions, and the information of T_a_b from its point pairs. Each pair holds the
/// surface's normal twice, as cloud a and as cloud b saw it, and the noise of the two is independent: the
/// products n_a n_b^T that stand in the Hessian instead of n_a n_a^T have no noise floor. A smooth tube then
/// has no information along its axis, where the plain Hessian of noisy normals pretends some (with sigma 6
/// degrees, 1 % of that across). Along motions by which the points hardly move against the walls (slippable
/// ones: along a tube, along a bend, about the axis of a round one) it counts no more than that both scans
/// are of one place (N. Gelfand and L. J. Guibas, SGP 2004). The squares of the residuals count by regions of
/// the cloud, within which they err alike (cluster-robust covariance, K.-Y. Liang and S. L. Zeger,
/// "Longitudinal data analysis using generalized linear models", Biometrika 1986).
[[nodiscard]] Evidence gather_evidence(const Features& a, const PointGrid& grid_a, const Features& b,
                                       const PointGrid& grid_b, const Pose& T_a_b,
                                       const RegistrationConfig& config);

/// Sets `verdict` and `reason` from the numbers in `registration`.
[[nodiscard]] Registration judged(Registration registration, const RegistrationConfig& config);

}  // namespace adit

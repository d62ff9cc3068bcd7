// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The residual of point-to-plane registration, as all of adit uses it (Chen and Medioni, "Object modelling
/// by registration of multiple range images", 1992). PlaneAligner evaluates the same terms eight at a time.
#pragma once

#include "adit/core/pose.hpp"

namespace adit {

/// A plane through `point`.
struct Plane {
  Vector3 point;   ///< Metres.
  Vector3 normal;  ///< Unit length, either sign.
};

/// The signed distance of a point from a plane, and how it changes with the pose.
struct PlaneResidual {
  double value = 0.0;                  ///< n_a . (T_a_b p_b - p_a), metres.
  Vector6 jacobian = Vector6::Zero();  ///< By xi in T_a_b * exp(xi): [n_b; p_b x n_b], n_b = R_a_b^T n_a.
};

/// Of point `p_b` (frame b) from `plane_a` (frame a), at the pose T_a_b = (R_a_b, t_a_b).
[[nodiscard]] PlaneResidual plane_residual(const Matrix3& R_a_b, const Vector3& t_a_b, const Plane& plane_a,
                                           const Vector3& p_b);

}  // namespace adit

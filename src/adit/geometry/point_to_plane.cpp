// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/point_to_plane.hpp"

namespace adit {

PlaneResidual plane_residual(const Matrix3& R_a_b, const Vector3& t_a_b, const Plane& plane_a,
                             const Vector3& p_b) {
  const Vector3 n_b = R_a_b.transpose() * plane_a.normal;
  PlaneResidual out{.value = plane_a.normal.dot(R_a_b * p_b + t_a_b - plane_a.point)};
  out.jacobian << n_b, p_b.cross(n_b);
  return out;
}

}  // namespace adit

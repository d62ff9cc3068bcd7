// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/point_to_plane.hpp"

#include <gtest/gtest.h>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

Vector3 in_cube(Rng& rng, double size) { return size * Vector3(rng.normal(), rng.normal(), rng.normal()); }

PlaneResidual residual_at(const Pose& T_a_b, const Plane& plane_a, const Vector3& p_b) {
  return plane_residual(T_a_b.rotation_matrix(), T_a_b.translation(), plane_a, p_b);
}

TEST(PlaneResidual, JacobianAgreesWithFiniteDifferencesAtLargeResiduals) {
  Rng rng(1);
  for (int k = 0; k < 50; ++k) {
    const Pose T(so3::exp(in_cube(rng, 1.5)), in_cube(rng, 10.0));
    const Plane plane{in_cube(rng, 10.0), in_cube(rng, 1.0).normalized()};
    const Vector3 p_b = in_cube(rng, 10.0);
    const PlaneResidual r = residual_at(T, plane, p_b);
    EXPECT_NEAR(r.value, plane.normal.dot(T * p_b - plane.point), 1e-12 * (1.0 + std::abs(r.value)) * 10.0);
    for (int d = 0; d < 6; ++d) {
      constexpr double kStep = 1e-6;
      const double ahead = residual_at(T * Pose::exp(kStep * Vector6::Unit(d)), plane, p_b).value;
      const double behind = residual_at(T * Pose::exp(-kStep * Vector6::Unit(d)), plane, p_b).value;
      EXPECT_NEAR(r.jacobian[d], (ahead - behind) / (2.0 * kStep), 1e-7);
    }
  }
}

TEST(PlaneResidual, IsTheDistanceInFrontOfThePlane) {
  const Plane floor{{5.0, 5.0, 1.0}, Vector3::UnitZ()};
  const PlaneResidual r = residual_at(Pose::translation_of(0.0, 0.0, 2.0), floor, {1.0, -2.0, 0.5});
  EXPECT_DOUBLE_EQ(r.value, 1.5);
  EXPECT_EQ(r.jacobian, (Vector6() << 0.0, 0.0, 1.0, -2.0, -1.0, 0.0).finished());
}

}  // namespace
}  // namespace adit

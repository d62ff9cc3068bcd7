// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/factors.hpp"

#include <gtest/gtest.h>

#include "support/graphs.hpp"

namespace adit {
namespace {

// Central differences of the residual in the perturbation of one end.
template <class P, class Residual>
typename P::Jacobian differences(const Residual& residual_at) {
  constexpr double h = 1e-6;
  typename P::Jacobian J;
  for (int i = 0; i < P::kDof; ++i) {
    const typename P::Tangent step = h * P::Tangent::Unit(i);
    J.col(i) = (residual_at(step) - residual_at(-step)) / (2.0 * h);
  }
  return J;
}

template <class P>
void expect_exact_jacobians() {
  Rng rng(7);
  for (int trial = 0; trial < 50; ++trial) {
    // Far apart on purpose: residuals of metres and radians, where dropped terms show.
    const P Z = test::random_pose<P>(rng, 3.0);
    const P a = test::random_pose<P>(rng, 10.0);
    const P b = test::random_pose<P>(rng, 10.0);
    if (between_residual(Z, a, b).template tail < P::kDof == 6 ? 3 : 1 > ().norm() > 3.0)
      continue;  // Log jumps at pi
    const BetweenFactor<P> f = linearize(Z, a, b);
    EXPECT_EQ(f.residual, between_residual(Z, a, b));
    const auto J_a = differences<P>([&](const auto& d) { return between_residual(Z, retract(a, d), b); });
    const auto J_b = differences<P>([&](const auto& d) { return between_residual(Z, a, retract(b, d)); });
    EXPECT_LT((f.d_from - J_a).norm(), 1e-6 * (1.0 + J_a.norm()));
    EXPECT_LT((f.d_to - J_b).norm(), 1e-6 * (1.0 + J_b.norm()));
  }
}

TEST(Factors, JacobiansAreExactAtLargeResidualsInSpace) { expect_exact_jacobians<Pose>(); }
TEST(Factors, JacobiansAreExactAtLargeResidualsInThePlane) { expect_exact_jacobians<Pose2>(); }

TEST(Factors, ResidualIsZeroWhereTheMeasurementHolds) {
  Rng rng(8);
  const Pose a = test::random_pose<Pose>(rng, 10.0);
  const Pose Z = test::random_pose<Pose>(rng, 10.0);
  EXPECT_LT(between_residual(Z, a, a * Z).norm(), 1e-13);
  const Pose2 a2 = test::random_pose<Pose2>(rng, 10.0);
  const Pose2 Z2 = test::random_pose<Pose2>(rng, 10.0);
  EXPECT_LT(between_residual(Z2, a2, a2 * Z2).norm(), 1e-13);
}

}  // namespace
}  // namespace adit

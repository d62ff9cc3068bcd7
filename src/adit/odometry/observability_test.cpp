// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/observability.hpp"

#include <gtest/gtest.h>

#include "adit/core/decompositions.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

// Points on the walls of a room, each with a plane through it, and regions that err as a whole.
struct Walls {
  std::vector<Eigen::Vector3f> points;
  std::vector<PlaneResidual> residuals;
};

Walls walls(Rng& rng, double of_point, double of_region) {
  Walls out;
  for (int wall = 0; wall < 6; ++wall) {
    const int axis = wall / 2;
    for (int region = 0; region < 16; ++region) {
      const double shared = of_region * rng.normal();
      for (int k = 0; k < 10; ++k) {
        Vector3 p;
        // In the middle of a region's cube of 2 m.
        p[(axis + 1) % 3] = 2.0 * (region % 4) - 3.0 + 1.8 * (rng.uniform() - 0.5);
        p[(axis + 2) % 3] = 2.0 * (region / 4) - 3.0 + 1.8 * (rng.uniform() - 0.5);
        p[axis] = wall % 2 == 0 ? 5.0 : -5.0;
        PlaneResidual residual =
            plane_residual(Matrix3::Identity(), Vector3::Zero(), {p, Vector3::Unit(axis)}, p);
        residual.value = shared + of_point * rng.normal();
        out.points.push_back(p.cast<float>());
        out.residuals.push_back(residual);
      }
    }
  }
  return out;
}

// Of least squares over such residuals, by the information that is stated; over its dimension.
double mean_nees(double of_point, double of_region) {
  double sum = 0.0;
  constexpr int kRuns = 200;
  for (int run = 0; run < kRuns; ++run) {
    Rng rng(static_cast<std::uint64_t>(run) + 1);
    Walls made = walls(rng, of_point, of_region);
    Matrix6 H = Matrix6::Zero();
    Vector6 g = Vector6::Zero();
    for (const PlaneResidual& r : made.residuals) {
      H += r.jacobian * r.jacobian.transpose();
      g += r.jacobian * r.value;
    }
    const Vector6 error = -solve_symmetric(H, g);
    for (PlaneResidual& r : made.residuals) r.value += r.jacobian.dot(error);
    const Matrix6 information =
        information_by_regions(made.residuals, made.points, Matrix6(Matrix6::Identity()));
    sum += error.dot(information * error) / 6.0;
  }
  return sum / kRuns;
}

TEST(InformationByRegions, IsThatOfTheErrorsWhetherPointsErrAloneOrTogether) {
  EXPECT_NEAR(mean_nees(0.05, 0.0), 1.0, 0.35);
  EXPECT_NEAR(mean_nees(0.02, 0.05), 1.0, 0.35);
}

TEST(InformationByRegions, SaysNothingOfOpenDirectionsAndIsDefinedForAFewPoints) {
  Rng rng(7);
  const Walls made = walls(rng, 0.02, 0.02);
  Matrix6 onto_fixed = Matrix6::Identity();
  onto_fixed(0, 0) = 0.0;
  const Matrix6 information = information_by_regions(made.residuals, made.points, onto_fixed);
  EXPECT_LT(information.row(0).norm(), 1e-6 * information.norm());
  EXPECT_GT(information(1, 1), 0.0);
  const std::vector<PlaneResidual> one(made.residuals.begin(), made.residuals.begin() + 1);
  const std::span<const Eigen::Vector3f> point(made.points.data(), 1);
  EXPECT_TRUE(information_by_regions(one, point, Matrix6(Matrix6::Identity())).allFinite());
  EXPECT_TRUE(information_by_regions({}, {}, Matrix6(Matrix6::Identity())).isZero());
}

}  // namespace
}  // namespace adit

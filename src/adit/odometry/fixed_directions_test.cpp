// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/fixed_directions.hpp"

#include <gtest/gtest.h>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

TEST(FixedDirections, InvertWithinTheDirectionsThatAreFixed) {
  Rng rng(3);
  Matrix6 root;
  for (int i = 0; i < 36; ++i) root(i) = rng.normal();
  root.row(4).setZero();
  const Matrix6 information = root.transpose() * root;  // of rank five
  const FixedDirections fixed(information);
  EXPECT_EQ(fixed.number(), 5);
  const Matrix6 covariance = fixed.inverse_of(information);
  EXPECT_TRUE((information * covariance * information).isApprox(information, 1e-9));
  EXPECT_TRUE((covariance * information * covariance).isApprox(covariance, 1e-9));
  EXPECT_TRUE(fixed.information(fixed.of_information(information)).isApprox(information, 1e-9));
  EXPECT_EQ(FixedDirections(Matrix6::Zero()).number(), 0);
}

TEST(WithSigmaAtLeast, RaisesOnlyWhatIsTooSmall) {
  const Matrix6 fine = Matrix6::Identity();
  EXPECT_TRUE(with_sigma_at_least(fine, 1e-4).isApprox(fine, 1e-12));
  Matrix6 negative = fine;
  negative(0, 0) = -1.0;
  const Matrix6 positive = with_sigma_at_least(negative, 1e-4);
  EXPECT_NEAR(positive(0, 0), 1e-8, 1e-12);
  EXPECT_NEAR(positive(1, 1), 1.0, 1e-12);
  EXPECT_EQ(with_sigma_at_least(negative, 0.0)(0, 0), 0.0);
}

}  // namespace
}  // namespace adit

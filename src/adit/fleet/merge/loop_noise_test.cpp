// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/loop_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "adit/core/angles.hpp"
#include "adit/core/decompositions.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr LoopNoise kNoise{.translation = 0.02, .rotation_deg = 0.1};

Matrix6 drawn_information() {
  Rng rng(1);
  const Matrix6 root = Matrix6::NullaryExpr([&] { return rng.uniform(-1.0, 1.0); });
  return 1e4 * (root * root.transpose() + Matrix6::Identity());
}

TEST(LoopNoise, AddsCovariances) {
  const Matrix6 information = drawn_information();
  const Matrix6 expected = inverse(information) + inverse(information_of(kNoise));
  const Matrix6 with = with_noise(kNoise, information);
  EXPECT_TRUE(inverse(with).isApprox(expected, 1e-9));
  EXPECT_TRUE(with == with.transpose());
}

TEST(LoopNoise, WhatIsNotKnownStaysUnknownAndWhatIsExactErrsByTheNoise) {
  Vector6 known;
  known << 0.0, 1e16, 1e16, 1e16, 1e16, 0.0;
  const Matrix6 with = with_noise(kNoise, known.asDiagonal());
  EXPECT_EQ(with(0, 0), 0.0);
  EXPECT_EQ(with(5, 5), 0.0);
  EXPECT_NEAR(std::sqrt(1.0 / with(1, 1)), 0.02, 1e-9);
  EXPECT_NEAR(std::sqrt(1.0 / with(3, 3)), 0.1 * kDegree, 1e-9);
  EXPECT_TRUE(with_noise(kNoise, Matrix6::Zero()).isZero());
}

TEST(LoopNoise, WhereItIsZeroItAddsNothing) {
  const Matrix6 information = drawn_information();
  EXPECT_TRUE(
      with_noise({.translation = 0.0, .rotation_deg = 0.0}, information).isApprox(information, 1e-12));
  Matrix6 expected = inverse(information);
  expected.topLeftCorner<3, 3>() += 4e-4 * Matrix3::Identity();
  const Matrix6 with = with_noise({.translation = 0.02, .rotation_deg = 0.0}, information);
  EXPECT_TRUE(inverse(with).isApprox(expected, 1e-9));
}

}  // namespace
}  // namespace adit

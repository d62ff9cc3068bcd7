// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/loop_noise.hpp"

#include <gtest/gtest.h>

#include "adit/core/decompositions.hpp"

namespace adit {
namespace {

constexpr LoopNoise kNoise{.translation = 0.02, .rotation_deg = 0.1};

TEST(LoopNoise, AddsCovariances) {
  Matrix6 root = Matrix6::Random();
  const Matrix6 information = 1e4 * (root * root.transpose() + Matrix6::Identity());
  const Matrix6 expected = inverse(information) + inverse(information_of(kNoise));
  EXPECT_TRUE(inverse(with_noise(kNoise, information)).isApprox(expected, 1e-9));
}

TEST(LoopNoise, WhatIsNotKnownStaysUnknownAndWhatIsExactErrsByTheNoise) {
  Vector6 known;
  known << 0.0, 1e12, 1e12, 1e12, 1e12, 0.0;
  const Matrix6 with = with_noise(kNoise, known.asDiagonal());
  EXPECT_EQ(with(0, 0), 0.0);
  EXPECT_EQ(with(5, 5), 0.0);
  EXPECT_NEAR(std::sqrt(1.0 / with(1, 1)), 0.02, 1e-6);
  EXPECT_NEAR(std::sqrt(1.0 / with(3, 3)), 0.1 * 3.14159265 / 180.0, 1e-7);
  EXPECT_TRUE(with_noise(kNoise, Matrix6::Zero()).isZero());
}

}  // namespace
}  // namespace adit

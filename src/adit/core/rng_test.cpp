// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/rng.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace adit {
namespace {

TEST(Rng, Mix64HasTheValuesOfSplitMix64) {
  // The first outputs of SplitMix64 seeded with 0, as its authors publish them.
  EXPECT_EQ(mix64(0), 0xe220a8397b1dcdafULL);
  EXPECT_EQ(mix64(0x9e3779b97f4a7c15ULL), 0x6e789e6aa1b965f4ULL);
  EXPECT_EQ(mix64(2 * 0x9e3779b97f4a7c15ULL), 0x06c45d188009454fULL);
}

TEST(Rng, TheSameSeedGivesTheSameNumbersForEver) {
  Rng a(42);
  Rng b(42);
  Rng other(43);
  bool differs = false;
  for (int i = 0; i < 100; ++i) {
    const std::uint64_t draw = a();
    EXPECT_EQ(draw, b());
    differs = differs || draw != other();
  }
  EXPECT_TRUE(differs);
}

TEST(Rng, UniformFillsItsInterval) {
  Rng rng(1);
  double sum = 0.0;
  double least = 1.0;
  double greatest = 0.0;
  constexpr int kDraws = 100000;
  for (int i = 0; i < kDraws; ++i) {
    const double u = rng.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    least = std::min(least, u);
    greatest = std::max(greatest, u);
  }
  EXPECT_NEAR(sum / kDraws, 0.5, 0.005);
  EXPECT_LT(least, 1e-3);
  EXPECT_GT(greatest, 1.0 - 1e-3);
  const double v = rng.uniform(-3.0, -2.0);
  EXPECT_TRUE(v >= -3.0 && v < -2.0);
}

TEST(Rng, BelowIsFair) {
  Rng rng(2);
  std::array<int, 7> counts{};
  constexpr int kDraws = 70000;
  for (int i = 0; i < kDraws; ++i) ++counts.at(rng.below(7));
  for (const int count : counts) EXPECT_NEAR(count, 10000, 400);
  EXPECT_EQ(rng.below(1), 0U);
}

TEST(Rng, NormalHasItsMoments) {
  Rng rng(3);
  double sum = 0.0;
  double squares = 0.0;
  double fourths = 0.0;
  constexpr int kDraws = 200000;
  for (int i = 0; i < kDraws; ++i) {
    const double x = rng.normal();
    ASSERT_TRUE(std::isfinite(x));
    sum += x;
    squares += x * x;
    fourths += x * x * x * x;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 0.01);
  EXPECT_NEAR(squares / kDraws, 1.0, 0.02);
  EXPECT_NEAR(fourths / kDraws, 3.0, 0.15);
}

TEST(Rng, HashesOfNeighboursAreUnrelated) {
  int equal_bits = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) equal_bits += 64 - std::popcount(mix64(i) ^ mix64(i + 1));
  EXPECT_NEAR(equal_bits / 1000.0, 32.0, 0.7);
  EXPECT_NE(mix64(1, 2), mix64(2, 1));
}

TEST(Rng, PoissonHasItsMomentsAndIsOfEventsThatComeOneByOne) {
  Rng rng(5);
  for (const double mean : {0.3, 4.0, 60.0}) {
    constexpr int kDraws = 20000;
    double sum = 0.0;
    double squares = 0.0;
    int none = 0;
    for (int i = 0; i < kDraws; ++i) {
      const auto num = static_cast<double>(rng.poisson(mean));
      sum += num;
      squares += num * num;
      none += num == 0.0 ? 1 : 0;
    }
    const double error = 4.0 * std::sqrt(mean / kDraws);
    EXPECT_NEAR(sum / kDraws, mean, error);
    EXPECT_NEAR(squares / kDraws - std::pow(sum / kDraws, 2), mean, 0.06 * mean);
    EXPECT_NEAR(none / static_cast<double>(kDraws), std::exp(-mean), 0.015);
  }
  EXPECT_EQ(rng.poisson(0.0), 0U);
}

TEST(Rng, NormalWithinTwoSigmaIsNeverFartherOut) {
  Rng rng(6);
  double squares = 0.0;
  constexpr int kDraws = 50000;
  for (int i = 0; i < kDraws; ++i) {
    const double draw = rng.normal_within_two_sigma();
    ASSERT_LE(std::abs(draw), 2.0);
    squares += draw * draw;
  }
  EXPECT_NEAR(std::sqrt(squares / kDraws), 0.880, 0.01);
}

}  // namespace
}  // namespace adit

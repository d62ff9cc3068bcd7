// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/adaptive_threshold.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace adit {
namespace {

TEST(PointDeviation, TranslationAndRotation) {
  EXPECT_DOUBLE_EQ(point_deviation(Pose(), 100.0), 0.0);
  EXPECT_DOUBLE_EQ(point_deviation(Pose::translation_of(3.0, 4.0, 0.0), 100.0), 5.0);
  EXPECT_NEAR(point_deviation(Pose::planar(0, 0, std::numbers::pi), 10.0), 20.0, 1e-12);  // to the other side
}

TEST(DeviationStatistics, NothingSeenIsZeroNotNan) {
  DeviationStatistics statistics;
  EXPECT_EQ(statistics.sigma(), 0.0);
  statistics.add(3.0);
  statistics.add(4.0);
  EXPECT_DOUBLE_EQ(statistics.sigma(), std::sqrt(12.5));
}

TEST(AdaptiveThreshold, IsTheRootMeanSquareSeededWithTheInitialThreshold) {
  AdaptiveThreshold threshold(2.0, 0.1, 100.0);
  EXPECT_DOUBLE_EQ(threshold.sigma(), 2.0);
  threshold.add(Pose::translation_of(1.0, 0.0, 0.0));
  EXPECT_DOUBLE_EQ(threshold.sigma(), std::sqrt(5.0 / 2.0));
  threshold.add(Pose::translation_of(0.05, 0.0, 0.0));  // below min_motion: does not count
  EXPECT_DOUBLE_EQ(threshold.sigma(), std::sqrt(5.0 / 2.0));
}

TEST(AdaptiveThreshold, FrozenSmallItRecoversAfterFailures) {
  AdaptiveThreshold threshold(2.0, 0.1, 100.0);
  for (int i = 0; i < 1000; ++i) threshold.add(Pose::translation_of(0.11, 0.0, 0.0));
  const double frozen = threshold.sigma();
  EXPECT_LT(frozen, 0.2);
  threshold.failed();
  EXPECT_DOUBLE_EQ(threshold.sigma(), 1.5 * frozen);
  for (int i = 0; i < 100; ++i) threshold.failed();
  EXPECT_DOUBLE_EQ(threshold.sigma(), 2.0);
  threshold.add(Pose());
  EXPECT_DOUBLE_EQ(threshold.sigma(), frozen);
}

TEST(AdaptiveThreshold, FailuresNeverShrinkIt) {
  AdaptiveThreshold threshold(0.5, 0.1, 100.0);
  threshold.add(Pose::translation_of(5.0, 0.0, 0.0));
  const double wide = threshold.sigma();
  threshold.failed();
  EXPECT_DOUBLE_EQ(threshold.sigma(), wide);
}

}  // namespace
}  // namespace adit

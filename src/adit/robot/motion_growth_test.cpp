// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/motion_growth.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

using std::chrono::milliseconds;

Stamp at(double seconds) { return Stamp{} + from_seconds(seconds); }

TEST(Growth, RatesAreOfOnePieceAlone) {
  Growth growth;
  growth.add(at(0.0), 0.0);
  growth.add(at(0.1), 1.0);
  growth.add(at(0.15), Growth::kNothing);
  growth.add(at(0.2), 50.0);
  growth.add(at(0.3), 51.0);
  EXPECT_NEAR(growth.rate(at(0.05), milliseconds(20)), 10.0, 1e-9);
  EXPECT_NEAR(growth.rate(at(0.25), milliseconds(50)), 10.0, 1e-9);
  // Both ends are known, but not what lies between them.
  EXPECT_TRUE(std::isnan(growth.rate(at(0.15), milliseconds(60))));
  EXPECT_TRUE(std::isnan(growth.at(at(0.12))));
  EXPECT_TRUE(std::isnan(growth.at(at(0.31))));
}

TEST(Growth, NothingIsKnownInGaps) {
  Growth growth(milliseconds(200));
  growth.add(at(0.0), 0.0);
  growth.add(at(0.3), 3.0);
  growth.add(at(0.5), 5.0);
  EXPECT_TRUE(std::isnan(growth.at(at(0.2))));
  EXPECT_NEAR(growth.at(at(0.4)), 4.0, 1e-9);
  EXPECT_EQ(growth.at(at(0.3)), 3.0);
}

/// An angle that swings, sampled every `interval` by a clock that is `late`, times `factor`.
Growth swinging(double interval, double late, double factor) {
  Growth growth(milliseconds(300));
  for (double t = 0.0; t < 12.0; t += interval)
    growth.add(at(t + late + 1.0), factor * (std::sin(1.7 * t) + 0.5 * std::cos(2.9 * t)));
  return growth;
}

TEST(CompareTurns, FindsLagScaleAndSign) {
  for (const double late : {0.0, 0.1, -0.25, 0.333}) {
    for (const double factor : {1.0, 1.1, -1.0}) {
      const TurnComparison turns =
          compare_turns(swinging(0.02, late, 1.0), swinging(0.1, 0.0, factor), milliseconds(100));
      EXPECT_NEAR(turns.late_s, late, 0.002);
      EXPECT_NEAR(turns.best.slope, factor, 0.02);
      EXPECT_TRUE(turns.agrees());
      EXPECT_LT(turns.unexplained, late == 0.0 ? 1.1 : 0.1);
    }
  }
}

// Both clocks are set forward by ten years in the middle, 0.1 s apart. A grid over all of that would not fit
// into memory.
TEST(CompareTurns, AClockThatJumpsIsNoSilenceToWalkThrough) {
  constexpr double kYears = 3.2e8;
  const auto jumping = [&](double interval, double late) {
    Growth growth(milliseconds(300));
    for (double t = 0.0; t < 24.0; t += interval)
      growth.add(at(t + late + (t < 12.0 ? 1.0 : kYears)), std::sin(1.7 * t) + 0.5 * std::cos(2.9 * t));
    return growth;
  };
  const TurnComparison turns = compare_turns(jumping(0.02, 0.1), jumping(0.1, 0.0), milliseconds(100));
  EXPECT_NEAR(turns.late_s, 0.1, 0.002);
  EXPECT_NEAR(turns.best.slope, 1.0, 0.02);
  EXPECT_GT(turns.best.num, 1000U);
  EXPECT_LT(turns.best.num, 1200U);
}

TEST(CompareTurns, LittleTurningSaysNothing) {
  const TurnComparison turns =
      compare_turns(swinging(0.02, 0.0, 0.005), swinging(0.1, 0.0, 0.005), milliseconds(100));
  EXPECT_FALSE(turns.has_curves());
  EXPECT_FALSE(turns.agrees());
}

}  // namespace
}  // namespace adit

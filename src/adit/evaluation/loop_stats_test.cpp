// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/loop_stats.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace adit {
namespace {

/// A loop whose keyframes are truly `apart` metres apart and whose transform errs by `error`.
LoopClass classify_made_up(double apart, const Pose& error) {
  const Pose T_world_from = Pose::planar(120.0, -7.0, 1.1, 4.0);
  const Pose T_from_to = Pose::translation_of(apart, 0.0, 0.0) * Pose::planar(0.0, 0.0, -2.0);
  LoopClosure loop;
  loop.T_from_to = T_from_to * error;
  return classify(loop, T_world_from, T_world_from * T_from_to);
}

Pose turn(double degrees) { return Pose::planar(0.0, 0.0, degrees * std::numbers::pi / 180.0); }

TEST(LoopStats, BordersOfTheThreeClasses) {
  EXPECT_EQ(classify_made_up(9.999, Pose()), LoopClass::correct);
  EXPECT_EQ(classify_made_up(10.001, Pose()), LoopClass::wrong_place);
  EXPECT_EQ(classify_made_up(3.0, Pose::translation_of(0.0, 0.999, 0.0)), LoopClass::correct);
  EXPECT_EQ(classify_made_up(3.0, Pose::translation_of(0.0, 1.001, 0.0)), LoopClass::wrong_registration);
  EXPECT_EQ(classify_made_up(3.0, turn(14.99)), LoopClass::correct);
  EXPECT_EQ(classify_made_up(3.0, turn(15.01)), LoopClass::wrong_registration);
  EXPECT_EQ(classify_made_up(3.0, turn(180.0)), LoopClass::wrong_registration);
}

TEST(LoopStats, AFarPlaceIsWrongHoweverWellRegistered) {
  EXPECT_EQ(classify_made_up(30.0, Pose()), LoopClass::wrong_place);
  EXPECT_EQ(classify_made_up(30.0, turn(90.0)), LoopClass::wrong_place);
}

TEST(LoopStats, TheClassDoesNotDependOnTheDirection) {
  const Pose T_world_from = Pose::planar(0.0, 0.0, 0.3);
  const Pose T_world_to = Pose::planar(4.0, 1.0, -2.0);
  LoopClosure loop;
  loop.to.robot.value = 1;
  for (const double error : {0.5, 1.5}) {
    loop.T_from_to = T_world_from.inverse() * T_world_to * Pose::translation_of(error, 0.0, 0.0);
    EXPECT_EQ(classify(loop, T_world_from, T_world_to), classify(reversed(loop), T_world_to, T_world_from));
  }
}

TEST(LoopStats, CountsAndShares) {
  LoopCounts counts;
  EXPECT_EQ(counts.wrong_place_pct(), 0.0);
  for (const LoopClass c :
       {LoopClass::correct, LoopClass::wrong_place, LoopClass::wrong_place, LoopClass::wrong_registration}) {
    counts.add(c);
  }
  EXPECT_EQ(counts.total, 4);
  EXPECT_EQ(counts.correct(), 1);
  EXPECT_DOUBLE_EQ(counts.wrong_place_pct(), 50.0);
  EXPECT_DOUBLE_EQ(counts.wrong_registration_pct(), 25.0);
  counts += counts;
  EXPECT_EQ(counts.wrong(), 6);
}

}  // namespace
}  // namespace adit

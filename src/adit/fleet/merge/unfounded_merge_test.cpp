// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Checks that have nothing, or nothing that can be computed, to decide by.
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "adit/fleet/merge/merge_checker.hpp"
#include "support/merge_checks.hpp"

namespace adit {
namespace {

using test::along_x;
using test::by_places;
using test::kAgrees;
using test::kNum;
using test::kTrueLoops;
using test::look_alikes;
using test::measured;
using test::run;

// Up a street and back on a lane 5 m beside: loops join both, but no place has a keyframe within reach.
TEST(UnfoundedMerge, WhatWasKnownBeforeAcceptsNothingWithoutAComparison) {
  std::vector<Pose> poses;
  for (int k = 0; k <= 200; ++k)
    poses.push_back(k <= 100 ? Pose::planar(k, 0.0, 0.0) : Pose::planar(200 - k, 5.0, std::numbers::pi));
  const OdometryChain chain(poses, std::vector<Matrix6>(200, Matrix6::Identity() * 1e-4));
  LoopsBetween between{chain, chain, {}, {20.0, 20.0, 20.0}};
  for (const std::size_t a : {50U, 60U, 70U})
    between.loops.push_back({a, 200 - a, chain.between(a, 200 - a), test::loop_information()});
  AdaptiveConfig config;
  config.merge_check = by_places();
  MergeChecker checker(between, {50.0, measured(look_alikes(0.5))}, config);
  const MergeCheck check = run(checker, [](const PlannedComparison&) { return kAgrees; });
  EXPECT_EQ(check.num_checked, 0U);
  EXPECT_GT(check.evidence, check.needed);
  EXPECT_FALSE(check.accepted);
  EXPECT_EQ(check.refused_kind, RefusalKind::too_little);
  EXPECT_NE(check.reason.find("no keyframes of both stand side by side"), std::string::npos) << check.reason;
  EXPECT_NE(check.reason.find("; drive where the other robot has driven"), std::string::npos);
}

TEST(UnfoundedMerge, EvidenceThatCannotBeComputedRefuses) {
  const OdometryChain own = along_x(kNum);
  const OdometryChain theirs = own;
  AdaptiveConfig config;
  config.merge_check = by_places();
  const auto checked = [&](double known_before) {
    const LoopsBetween between{own, theirs, kTrueLoops, std::vector<double>(3, known_before)};
    MergeChecker checker(between, {50.0, measured(look_alikes(0.5))}, config);
    return run(checker, [](const PlannedComparison&) { return kAgrees; });
  };
  EXPECT_TRUE(checked(0.0).accepted);
  EXPECT_FALSE(checked(std::numeric_limits<double>::quiet_NaN()).accepted);
}

}  // namespace
}  // namespace adit

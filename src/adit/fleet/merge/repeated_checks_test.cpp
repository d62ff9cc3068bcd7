// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Robots that meet again, and their checks.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "adit/fleet/merge/merge_checker.hpp"
#include "support/merge_checks.hpp"

namespace adit {
namespace {

using test::by_places;
using test::checker_of;
using test::kAgrees;
using test::kDiffers;
using test::kNum;
using test::kTrueLoops;
using test::look_alikes;
using test::loop_at;
using test::measured;
using test::run;

MergeCheck checked(const std::vector<PcmLoop>& loops, const MergeCheck* earlier,
                   const ComparedPlace& answer = kAgrees) {
  MergeChecker checker =
      checker_of(loops, measured(look_alikes(0.5)), by_places(), test::along_x(kNum), earlier);
  return run(checker, [&](const PlannedComparison&) { return answer; });
}

std::vector<PcmLoop> moved(std::vector<PcmLoop> loops, double metres) {
  for (PcmLoop& loop : loops) {
    loop.T_a_b = Pose::planar(metres, 0.0, 0.0) * loop.T_a_b;
    ++loop.a;
  }
  return loops;
}

const double kNeeded = std::log(1.0 / EvidenceModel().error_rate);

TEST(RepeatedChecks, OfTheSameAlignmentNeedNoMore) {
  const MergeCheck first = checked(kTrueLoops, nullptr);
  EXPECT_EQ(first.needed, kNeeded);
  const MergeCheck second = checked(kTrueLoops, &first);
  EXPECT_EQ(second.needed, kNeeded);
  EXPECT_EQ(second.evidence, first.evidence);
  std::vector<PcmLoop> more = kTrueLoops;
  more.push_back(loop_at(60));
  EXPECT_EQ(checked(more, &second).needed, kNeeded) << "its loops have become more";
}

TEST(RepeatedChecks, WhereNothingWasFoundBeforeNeedNoMore) {
  const MergeCheck first = checked({}, nullptr);
  EXPECT_TRUE(first.hypotheses.empty());
  EXPECT_EQ(checked(kTrueLoops, &first).needed, kNeeded);
}

TEST(RepeatedChecks, OfTwoAlignmentsCountWhatOneOfThemHasMoreThanBefore) {
  const std::vector<PcmLoop> other = moved(kTrueLoops, 30.0);
  std::vector<PcmLoop> loops = kTrueLoops;
  loops.insert(loops.end(), other.begin(), other.begin() + 2);
  const MergeCheck first = checked(loops, nullptr);  // 3 of 5 and 2 of 5
  ASSERT_EQ(first.hypotheses.size(), 2U);
  EXPECT_EQ(checked(loops, &first).needed, kNeeded);
  loops.push_back(other[2]);  // 3 of 6 each
  EXPECT_NEAR(checked(loops, &first).needed, std::log(1.1) + kNeeded, 1e-12);
}

TEST(RepeatedChecks, OfFurtherAlignmentsNeedMoreForEach) {
  const MergeCheck first = checked(moved(kTrueLoops, 30.0), nullptr, kDiffers);
  EXPECT_FALSE(first.accepted);
  const MergeCheck second = checked(kTrueLoops, &first);
  EXPECT_NEAR(second.needed, std::log(2.0) + kNeeded, 1e-12);
  const MergeCheck third = checked(moved(kTrueLoops, -30.0), &second);
  EXPECT_NEAR(third.needed, std::log(3.0) + kNeeded, 1e-12);
  // As it is: loops stay known, so that an alignment is put forward again.
  std::vector<PcmLoop> both = kTrueLoops;
  for (const PcmLoop& loop : moved(kTrueLoops, 30.0)) both.push_back(loop);
  EXPECT_NEAR(checked(both, &first).needed, std::log(1.5) + kNeeded, 1e-12);
}

}  // namespace
}  // namespace adit

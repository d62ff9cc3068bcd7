// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Alignments of two maps that compete with one another.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "adit/fleet/merge/merge_checker.hpp"
#include "support/merge_checks.hpp"

namespace adit {
namespace {

using test::a_check;
using test::along_x;
using test::by_places;
using test::kAgrees;
using test::kDiffers;
using test::kNum;
using test::kSilent;
using test::kTrueLoops;
using test::look_alikes;
using test::loop_at;
using test::measured;
using test::run;
using test::T_a_b_true;

TEST(MergeRival, TwoHypothesesWithTheSameSupportDecideNothing) {
  std::vector<PcmLoop> loops = kTrueLoops;
  for (const std::size_t a : {70U, 120U, 130U}) loops.push_back(loop_at(a, 20.0));
  MergeChecker checker = a_check(loops);
  const MergeCheck check = run(checker, [](const PlannedComparison&) { return kAgrees; });
  EXPECT_FALSE(check.accepted);
  EXPECT_NE(check.reason.find("two hypotheses 20 m apart along the tunnel have similar support"),
            std::string::npos)
      << check.reason;
  EXPECT_NE(check.reason.find("drive on until"), std::string::npos) << check.reason;
  ASSERT_EQ(check.hypotheses.size(), 2U);
  EXPECT_EQ(check.hypotheses[0].outcome, HypothesisOutcome::rival);
  EXPECT_EQ(check.hypotheses[1].outcome, HypothesisOutcome::rival);
}

// Every fourth place of the second one differs, by a few changes that each is seen from several.
MergeCheck against_a_rival(double rival_rate) {
  std::vector<PcmLoop> loops = kTrueLoops;
  for (const std::size_t a : {70U, 120U, 130U}) loops.push_back(loop_at(a, 20.0));
  MergeCheckConfig config = by_places();
  config.evidence.rival_rate = rival_rate;
  MergeChecker checker = a_check(loops, 0.5, config);
  return run(checker, [](const PlannedComparison& asked) {
    const double off =
        (asked.T_own_theirs.inverse() * T_a_b_true(asked.own, asked.theirs)).translation().norm();
    ComparedPlace place = kAgrees;
    if (off > 5.0 && asked.theirs % 4 == 0) {
      place = kDiffers;
      place.structures.emplace_back(20.0 * std::round(asked.theirs / 50.0), 0.0, 0.0);
    }
    return place;
  });
}

TEST(MergeRival, ARivalIsOneThatMayBeTrueByTheRateStated) {
  const MergeCheck ahead = against_a_rival(0.02);
  ASSERT_EQ(ahead.hypotheses.size(), 2U);
  const double lead = ahead.evidence - ahead.hypotheses[1].evidence;
  ASSERT_GT(lead, 1.0);
  EXPECT_TRUE(against_a_rival(1.01 * std::exp(-lead)).accepted);
  const MergeCheck rival = against_a_rival(0.99 * std::exp(-lead));
  EXPECT_FALSE(rival.accepted);
  EXPECT_EQ(rival.refused_kind, RefusalKind::rival);
}

TEST(MergeRival, RivalsToEitherSideOfTheFirstAreAsFarApartAsTheyAre) {
  std::vector<PcmLoop> loops = kTrueLoops;  // refuted; 20 m to each side of it two others agree everywhere
  loops.push_back(loop_at(95));
  for (const std::size_t a : {70U, 120U, 130U}) loops.push_back(loop_at(a, 20.0));
  for (const std::size_t a : {60U, 65U, 75U}) loops.push_back(loop_at(a, -20.0));
  MergeChecker checker = a_check(loops);
  const MergeCheck check = run(checker, [](const PlannedComparison& asked) {
    const double off =
        (asked.T_own_theirs.inverse() * T_a_b_true(asked.own, asked.theirs)).translation().norm();
    return off < 5.0 ? kDiffers : kAgrees;
  });
  EXPECT_NE(check.reason.find("two hypotheses 40 m apart"), std::string::npos) << check.reason;
}

TEST(MergeRival, ThatLoopsAreFewDoesNotDecideBetweenTwo) {
  std::vector<PcmLoop> loops = kTrueLoops;
  for (const std::size_t a : {70U, 120U}) loops.push_back(loop_at(a, 20.0));
  const auto checked = [&](double rival_rate) {
    MergeCheckConfig config = by_places();
    config.evidence.rival_rate = rival_rate;
    MergeChecker checker = a_check(loops, 0.5, config);
    return run(checker, [](const PlannedComparison&) { return kAgrees; });
  };
  const MergeCheck first = checked(0.02);
  ASSERT_EQ(first.hypotheses.size(), 2U);
  // The lead is larger by a half than what is needed, and few loops make two of it.
  const double lead = first.evidence - first.hypotheses[1].evidence;
  EXPECT_EQ(checked(std::exp(0.5 - lead)).refused_kind, RefusalKind::rival);
}

// The second has more loops and differs at some places. The third agrees everywhere, by two loops: what few
// loops take away puts it behind the second, and is no reason why it should not be the right one.
TEST(MergeRival, TheNearestRivalNeedNotBeTheSecondByEvidence) {
  std::vector<PcmLoop> loops = kTrueLoops;
  for (const std::size_t a : {70U, 100U, 120U, 130U}) loops.push_back(loop_at(a, 20.0));
  for (const std::size_t a : {60U, 75U}) loops.push_back(loop_at(a, -20.0));
  const auto checked = [&](double rival_rate) {
    MergeCheckConfig config = by_places();
    config.evidence.rival_rate = rival_rate;
    MergeChecker checker = a_check(loops, 0.5, config);
    return run(checker, [](const PlannedComparison& asked) {
      const double along =
          (T_a_b_true(asked.own, asked.theirs).inverse() * asked.T_own_theirs).translation().x();
      ComparedPlace place = kAgrees;
      if (along < -5.0 && asked.theirs > 40 && asked.theirs < 44) {
        place = kDiffers;
        place.structures.emplace_back(20.0 * std::round(asked.theirs / 50.0), 0.0, 0.0);
      }
      return place;
    });
  };
  const MergeCheck check = checked(1e-6);
  ASSERT_EQ(check.hypotheses.size(), 3U);
  const auto& of_many = *std::ranges::max_element(
      check.hypotheses, {}, [](const MergeHypothesis& h) { return h.loops.size() == 4 ? 1 : 0; });
  const auto& of_few = *std::ranges::min_element(check.hypotheses, {},
                                                 [](const MergeHypothesis& h) { return h.loops.size(); });
  ASSERT_EQ(of_many.loops.size(), 4U);
  ASSERT_EQ(of_few.loops.size(), 2U);
  ASSERT_LT(of_few.evidence, of_many.evidence);
  // The one of many loops is left behind by this rate, the other is not.
  const MergeCheck refused = checked(1.01 * std::exp(of_many.evidence - check.evidence));
  EXPECT_FALSE(refused.accepted);
  EXPECT_EQ(refused.refused_kind, RefusalKind::rival);
  EXPECT_EQ(refused.hypotheses[1].loops.size(), 2U);
  EXPECT_EQ(refused.hypotheses[1].outcome, HypothesisOutcome::rival);
  EXPECT_NE(refused.reason.find("20 m apart"), std::string::npos) << refused.reason;
}

TEST(MergeRival, AHypothesisFarBehindTheBestIsNoRival) {
  std::vector<PcmLoop> loops = kTrueLoops;
  loops.push_back(loop_at(120, 20.0));
  MergeChecker checker = a_check(loops);
  const MergeCheck check = run(checker, [](const PlannedComparison& asked) {
    const double off =
        (asked.T_own_theirs.inverse() * T_a_b_true(asked.own, asked.theirs)).translation().norm();
    return off > 5.0 ? kSilent : kAgrees;
  });
  EXPECT_TRUE(check.accepted) << check.reason;
  ASSERT_EQ(check.hypotheses.size(), 2U);
  EXPECT_EQ(check.hypotheses[1].outcome, HypothesisOutcome::behind);
}

// The second alignment is behind. Where it agrees at most places, too, there are tunnels here that agree
// although they are two, if the first one is true.
TEST(MergeRival, AnotherAlignmentThatAgreesAsCopiesDoLeavesPlacesLittleToSay) {
  const OdometryChain own = along_x(kNum);
  const OdometryChain theirs = own;
  const LookAlikes look_alike = look_alikes(0.5);
  LoopsBetween between{own, theirs, kTrueLoops, {3.0, 3.0, 3.0, 0.0, 0.0, 0.0}};
  for (const std::size_t a : {120U, 130U, 140U}) between.loops.push_back(loop_at(a, 60.0));
  const auto checked = [&](std::uint32_t one_in) {
    MergeChecker checker(between, {50.0, measured(look_alike)}, {});
    return run(checker, [&](const PlannedComparison& asked) {
      const double off =
          (asked.T_own_theirs.inverse() * T_a_b_true(asked.own, asked.theirs)).translation().norm();
      ComparedPlace place = kAgrees;
      if (off > 5.0 && asked.theirs / 10 % one_in == 0) {
        place = kDiffers;
        place.structures.emplace_back(asked.theirs, 0.0, 0.0);
      }
      return place;
    });
  };
  const MergeCheck unlike = checked(2);
  const MergeCheck copied = checked(6);
  const auto share = [&](const MergeCheck& check) {
    EXPECT_EQ(check.hypotheses.size(), 2U);
    EXPECT_EQ(check.hypotheses.back().outcome, HypothesisOutcome::behind);
    return share_of_copies({counted_places(check.hypotheses.back().places, look_alike.chances())});
  };
  EXPECT_TRUE(unlike.accepted) << unlike.reason;
  EXPECT_NEAR(unlike.evidence - copied.evidence, std::log(share(copied) / share(unlike)), 1e-3);
  EXPECT_GT(unlike.evidence - copied.evidence, 1.0);
}

TEST(MergeRival, ALeadThatCannotBeComputedIsNone) {
  const OdometryChain own = along_x(kNum);
  const OdometryChain theirs = own;
  AdaptiveConfig config;
  config.merge_check = by_places();
  const auto checked = [&](double of_first, double of_second) {
    LoopsBetween between{own, theirs, kTrueLoops, std::vector<double>(3, of_first)};
    between.loops.push_back(loop_at(120, 20.0));
    between.known_before.push_back(of_second);
    MergeChecker checker(between, {50.0, measured(look_alikes(0.5))}, config);
    return run(checker, [](const PlannedComparison&) { return kAgrees; });
  };
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(checked(20.0, 0.0).accepted);
  EXPECT_FALSE(checked(kInfinite, kInfinite).accepted);
  EXPECT_FALSE(checked(20.0, std::numeric_limits<double>::quiet_NaN()).accepted);
}

// By scans the first one is far ahead, and then its walls are those of another tunnel.
TEST(MergeRival, OneThatWasLeftBehindIsComparedToTheEndWhereTheWallsPutItInFront) {
  const OdometryChain own = along_x(kNum);
  const OdometryChain theirs = own;
  LoopsBetween between{own, theirs, kTrueLoops, {0.0, 0.0, 0.0, 4.0, 4.0, 4.0}};
  for (const std::size_t a : {120U, 130U, 140U}) between.loops.push_back(loop_at(a, 60.0));
  EqualSignShares shares;
  for (int i = 0; i < 10; ++i) shares.add_other({1000, 0.65, 0.015});
  MergeChecker checker{between, {50.0, measured(look_alikes(0.5), shares)}, {}};
  const MergeCheck check = run(checker, [](const PlannedComparison& asked) {
    const double off =
        (asked.T_own_theirs.inverse() * T_a_b_true(asked.own, asked.theirs)).translation().norm();
    if (off > 5.0) return kSilent;
    ComparedPlace place = kAgrees;
    for (int i = 0; i < 100; ++i)
      for (const double metres : {0.01, i % 10 * 10 + i / 10 < 80 ? 0.01 : -0.01})
        place.offsets.push_back({{static_cast<int>(asked.theirs), i, 0, 0}, metres});
    return place;
  });
  EXPECT_FALSE(check.accepted);
  ASSERT_EQ(check.hypotheses.size(), 2U);
  EXPECT_EQ(check.loops.size(), 3U);
  EXPECT_EQ(check.loops.back().first, 140U) << "the second one is the best: " << check.reason << "; "
                                            << check.evidence << " and " << check.hypotheses[1].evidence;
  EXPECT_GT(check.num_checked, 8U) << "not only the first 8: " << check.reason;
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/merge_checker.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <set>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"
#include "adit/fleet/merge/merge_evidence.hpp"
#include "support/merge_checks.hpp"

namespace adit {
namespace {

using test::a_check;
using test::along_x;
using test::by_places;
using test::checker_of;
using test::kAgrees;
using test::kDiffers;
using test::kHasANiche;
using test::kNum;
using test::kSilent;
using test::kTrueLoops;
using test::look_alikes;
using test::loop_at;
using test::measured;
using test::run;
using test::T_a_b_true;

TEST(MergeChecker, ALoopThatItsNeighboursContradictIsLeftOut) {
  std::vector<PcmLoop> loops;
  for (const std::uint32_t at : {70U, 80U, 90U, 100U, 110U}) loops.push_back(loop_at(at));
  loops[2].T_a_b = loops[2].T_a_b * Pose::translation_of(1.0, 0.0, 0.0);
  const OdometryChain chain = along_x(kNum, 0.05);  // which would allow it
  const auto loops_of = [&](const std::vector<PcmLoop>& some) {
    MergeChecker checker = checker_of(some, measured(look_alikes(0.5)), by_places(), chain);
    const MergeCheck check = run(checker, [](const PlannedComparison&) { return kAgrees; });
    EXPECT_TRUE(check.accepted) << check.reason;
    return check.loops;
  };
  const auto kept = loops_of(loops);
  EXPECT_EQ(kept.size(), 4U);
  EXPECT_EQ(std::ranges::count(kept, 90U, &std::pair<std::uint32_t, std::uint32_t>::first), 0);
  EXPECT_EQ(loops_of({loops[1], loops[2]}).size(), 2U) << "nobody knows which of the two is right";
}

// A thing in every so many places, 9 m apart from the next one at least.
MergeCheck check_with_things(std::uint32_t every) {
  MergeChecker checker = a_check(kTrueLoops);
  return run(checker, [&](const PlannedComparison& check) {
    ComparedPlace place = kAgrees;
    if (check.theirs % every == 0) place.things.emplace_back(9.0 * check.theirs, 0.0, 0.0);
    return place;
  });
}

TEST(MergeChecker, WhatComesAndGoesIsCountedAndNoEvidence) {
  const MergeCheck none = check_with_things(1'000'000);
  const MergeCheck many = check_with_things(1);
  EXPECT_TRUE(many.accepted) << many.reason;
  EXPECT_EQ(many.evidence, none.evidence);
  EXPECT_GT(many.hypotheses.front().counts.num_things, 10U);
}

TEST(MergeChecker, AfterAPlaceThatDiffersTheCountStartsAnew) {
  LookAlikes rarely_begin;  // and go on once they have
  for (int i = 0; i < 1000; ++i) i < 100 ? rarely_begin.add_agreed(0) : rarely_begin.add_differed(0);
  for (int i = 0; i < 1000; ++i) i < 950 ? rarely_begin.add_agreed(1) : rarely_begin.add_differed(1);
  const auto evidence = [&](std::uint32_t differs_at) {
    MergeChecker checker = checker_of(kTrueLoops, measured(rarely_begin));
    const std::uint32_t first =
        checker.next(1).front().own % 6;  // a place every six, looked at again two keyframes away
    return run(checker,
               [&](const PlannedComparison& check) {
                 return (check.own + 3 - first) / 6 == differs_at ? kDiffers : kAgrees;
               })
        .evidence;
  };
  const double never = evidence(1000);
  const double in_the_middle = evidence(15);
  // One place differs instead of going on, and the next one begins anew.
  const double begins =
      std::log(kFleetEvidence.agreement_if_true / chance_to_go_on(rarely_begin.chances(), 0));
  const double goes_on =
      std::log(kFleetEvidence.agreement_if_true / chance_to_go_on(rarely_begin.chances(), 1));
  const double differs =
      std::log((1.0 - kFleetEvidence.agreement_if_true) / (1.0 - chance_to_go_on(rarely_begin.chances(), 1)));
  EXPECT_NEAR(in_the_middle - never, differs - goes_on + begins - goes_on, 0.05);
}

TEST(MergeChecker, APlaceDiffersOnlyIfItDoesByASecondLook) {
  const auto checked = [&](bool also_beside) {
    MergeChecker checker = a_check(kTrueLoops);
    const std::uint32_t at = checker.next(1).front().own;
    std::size_t num_asked = 0;
    const MergeCheck check = run(checker, [&](const PlannedComparison& asked) {
      ++num_asked;
      const bool is_beside = asked.own != at && asked.own < at + 4 && at < asked.own + 4;
      return asked.own == at || (also_beside && is_beside) ? kDiffers : kAgrees;
    });
    EXPECT_EQ(num_asked, check.num_checked + 1) << "only that place is looked at again";
    return check;
  };
  const MergeCheck agrees = checked(false);
  EXPECT_EQ(agrees.num_passed, agrees.num_checked);
  EXPECT_NEAR(agrees.evidence, agrees.num_checked * std::log(kFleetEvidence.agreement_if_true / 0.5), 1e-9);
  const MergeCheck differs = checked(true);
  EXPECT_EQ(differs.num_passed + 1, differs.num_checked);
}

TEST(MergeChecker, PlacesThatAgreeJoinTheMaps) {
  MergeChecker checker = a_check(kTrueLoops);
  const MergeCheck check = run(checker, [](const PlannedComparison&) { return kAgrees; });
  EXPECT_TRUE(check.accepted) << check.reason;
  EXPECT_EQ(check.num_passed, check.num_checked);
  EXPECT_NEAR(check.evidence, check.num_checked * std::log(kFleetEvidence.agreement_if_true / 0.5), 1e-9);
  EXPECT_NEAR(check.needed, std::log(500.0), 1e-9);
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> loops = {{80, 119}, {90, 109}, {100, 99}};
  EXPECT_EQ(check.loops, loops);
  ASSERT_EQ(check.hypotheses.size(), 1U);
  EXPECT_EQ(check.hypotheses[0].outcome, HypothesisOutcome::accepted);
  EXPECT_EQ(check.hypotheses[0].loops, loops);
  EXPECT_EQ(check.hypotheses[0].evidence, check.evidence);
}

// Every so many places differ, each by structure at another spot or all by that at the same one.
MergeCheck check_with_structures(int every, double apart_m) {
  MergeChecker checker = a_check(kTrueLoops);
  return run(checker, [&](const PlannedComparison& asked) {
    if (static_cast<int>(asked.own / 12) % every != 0) return kAgrees;
    ComparedPlace place = kHasANiche;
    place.structures = {{apart_m * asked.own, 0.0, 0.0}};
    return place;
  });
}

TEST(MergeChecker, AStretchThatDiffersHereAndThereIsACopy) {
  const MergeCheck check = check_with_structures(2, 20.0);
  EXPECT_FALSE(check.accepted);
  EXPECT_NE(check.reason.find("scans differ at"), std::string::npos) << check.reason;
  EXPECT_EQ(check.refused_kind, RefusalKind::changed_or_other);
  EXPECT_NE(check.reason.find("cannot be told; "), std::string::npos) << check.reason;
  EXPECT_EQ(check.hypotheses.at(0).outcome, HypothesisOutcome::refuted);
  EXPECT_EQ(check.hypotheses.at(0).num_differing(), check.num_checked - check.num_passed);
}

TEST(MergeChecker, AChangeThatIsSeenFromManyPlacesCountsOnce) {
  const MergeCheck one = check_with_structures(4, 0.0);
  EXPECT_TRUE(one.accepted) << one.reason;
  EXPECT_EQ(one.num_checked, one.num_passed + 1);
}

TEST(MergeChecker, WhereEveryPlaceShowsOneChangeNothingSpeaksForAMerge) {
  const MergeCheck one = check_with_structures(1, 0.0);
  EXPECT_FALSE(one.accepted);
  EXPECT_EQ(one.hypotheses.at(0).outcome, HypothesisOutcome::unsure) << "nor does one object refute it";
  EXPECT_LT(one.evidence, 0.0);
  EXPECT_GT(one.num_checked, 8U) << "so that it is tested to the end";
}

// So many changes are seen from all places, and beside them what a displacement would not leave. That is
// asked of places where nothing new differs, each once.
MergeCheck check_with_changes_in_view(int num) {
  MergeChecker checker = a_check(kTrueLoops);
  std::set<std::uint32_t> asked_for_signs;
  return run(checker, [&](const PlannedComparison& asked) {
    ComparedPlace place = kHasANiche;
    place.structures.clear();
    for (int i = 0; i < num; ++i) place.structures.emplace_back(100.0 * i, 0.0, 0.0);
    if (asked.question == PlaceQuestion::displacement) {
      place.signs = {{Vector3(0.0, 50.0, 0.0)}, {Vector3(0.0, -50.0, 0.0)}};
      EXPECT_TRUE(asked_for_signs.insert(asked.own).second);
    }
    return place;
  });
}

TEST(MergeChecker, AFewChangesThatAreSeenFromEverywhereDoNotRefute) {
  const MergeCheck five = check_with_changes_in_view(5);  // on 122 m, where 3.7 are usual at worst
  EXPECT_TRUE(five.accepted) << five.reason;
  EXPECT_EQ(five.hypotheses.at(0).counts.num_changes, 5U);
  EXPECT_EQ(five.num_checked, five.num_passed + 1);
  const MergeCheck twelve = check_with_changes_in_view(12);
  EXPECT_EQ(twelve.hypotheses.at(0).outcome, HypothesisOutcome::refuted) << twelve.reason;
  EXPECT_EQ(twelve.num_checked, 8U) << "of 34";
}

// Where another one says nothing, but has been compared to the end.
TEST(MergeChecker, AHypothesisIsNotGivenUpWhileSecondLooksCouldSaveIt) {
  std::vector<PcmLoop> loops = kTrueLoops;
  loops.push_back(loop_at(120, 20.0));
  MergeChecker checker = a_check(loops);
  const std::uint32_t first = checker.next(1).front().own;
  const MergeCheck check = run(checker, [&](const PlannedComparison& asked) {
    const double off =
        (asked.T_own_theirs.inverse() * T_a_b_true(asked.own, asked.theirs)).translation().norm();
    if (off > 5.0) return kSilent;
    const std::uint32_t from_first = asked.own > first ? asked.own - first : first - asked.own;
    const bool is_second_look = from_first % 12 != 0;
    return is_second_look || from_first % 36 == 0 ? kAgrees : kDiffers;
  });
  EXPECT_TRUE(check.accepted) << check.reason;
  EXPECT_EQ(check.num_passed, check.num_checked);
}

TEST(MergeChecker, ARefutedHypothesisIsNotTestedToTheEnd) {
  MergeChecker checker = a_check(kTrueLoops);
  const MergeCheck check = run(checker, [](const PlannedComparison&) { return kDiffers; });
  EXPECT_FALSE(check.accepted);
  EXPECT_EQ(check.num_checked, 24U) << "of 34";
}

TEST(MergeChecker, WhatIsRefutedNeedsNoMeasuringOfTheOwnMap) {
  const MeasuredWhenAsked nobody_asks = []() -> const Measured& { throw std::logic_error("asked"); };
  MergeChecker checker = checker_of(kTrueLoops, nobody_asks);
  const MergeCheck check = run(checker, [](const PlannedComparison&) { return kDiffers; });
  EXPECT_FALSE(check.accepted);
  ASSERT_EQ(check.hypotheses.size(), 1U);
  EXPECT_EQ(check.hypotheses.front().outcome, HypothesisOutcome::refuted);
  MergeChecker other = checker_of(kTrueLoops, nobody_asks);
  EXPECT_THROW(run(other, [](const PlannedComparison&) { return kAgrees; }), std::logic_error);
}

TEST(MergeChecker, PlacesWithoutAnAlongAxisConstraintSayNothing) {
  MergeChecker checker = a_check(kTrueLoops);
  const MergeCheck check = run(checker, [](const PlannedComparison&) { return kSilent; });
  EXPECT_FALSE(check.accepted);
  EXPECT_NE(check.reason.find("no along-axis constraint"), std::string::npos) << check.reason;
  EXPECT_NE(check.reason.find("drive on until both pass a junction"), std::string::npos) << check.reason;
}

TEST(MergeChecker, WhereLookAlikesGoOnForLongALongerStretchIsNeeded) {
  MergeChecker checker = a_check(kTrueLoops, 0.9);
  const MergeCheck check = run(checker, [](const PlannedComparison&) { return kAgrees; });
  EXPECT_FALSE(check.accepted);
  EXPECT_EQ(check.hypotheses.at(0).outcome, HypothesisOutcome::unsure);
  // What every further 3 m bring, and what is missing, rounded up to 10 m.
  const double metres =
      3.0 * std::ceil((check.needed - check.evidence) / std::log(kFleetEvidence.agreement_if_true / 0.9));
  const std::string asked =
      "drive the same stretch for about another " + std::to_string(10 * std::lround(std::ceil(metres / 10)));
  EXPECT_NE(check.reason.find(asked + " m"), std::string::npos) << check.reason;
}

TEST(MergeChecker, WhereTunnelsLookAlikeForeverNoDriveAlongThemIsAskedFor) {
  MergeChecker checker = a_check(kTrueLoops, 0.9899);
  const MergeCheck check = run(checker, [](const PlannedComparison&) { return kAgrees; });
  EXPECT_NE(check.reason.find("past a junction or a niche"), std::string::npos) << check.reason;
}

TEST(MergeChecker, ASmallerSetOfLoopsWinsWhereTheLargestIsRefuted) {
  std::vector<PcmLoop> loops = kTrueLoops;
  for (const std::size_t a : {60U, 70U, 110U, 120U}) loops.push_back(loop_at(a, 30.0));
  MergeChecker checker = a_check(loops);
  const MergeCheck check = run(checker, [](const PlannedComparison& asked) {
    const double off =
        (asked.T_own_theirs.inverse() * T_a_b_true(asked.own, asked.theirs)).translation().norm();
    return off > 5.0 ? kDiffers : kAgrees;
  });
  EXPECT_TRUE(check.accepted) << check.reason;
  EXPECT_EQ(check.loops.size(), 3U);
  EXPECT_EQ(check.loops.front().first, 80U);
  ASSERT_EQ(check.hypotheses.size(), 2U);
  EXPECT_EQ(check.hypotheses[0].outcome, HypothesisOutcome::accepted);
  EXPECT_EQ(check.hypotheses[1].outcome, HypothesisOutcome::refuted);
  EXPECT_EQ(check.hypotheses[1].loops.size(), 4U);
  EXPECT_NEAR(check.hypotheses[1].from_best_m, 30.0, 0.5);
}

TEST(MergeChecker, TellsOfABoundedNumberOfHypotheses) {
  std::vector<PcmLoop> loops;
  for (std::size_t h = 0; h < 20; ++h) loops.push_back(loop_at(190, 4.0 * static_cast<double>(h)));
  MergeCheckConfig config;
  config.max_hypotheses = 1000;
  MergeChecker checker = a_check(loops, 0.5, config);
  EXPECT_EQ(run(checker, [](const PlannedComparison&) { return kDiffers; }).hypotheses.size(),
            kHypothesesPerCheck);
}

TEST(MergeChecker, WithoutLoopsItIsOverAtOnce) {
  MergeChecker checker = a_check({});
  EXPECT_TRUE(checker.next(16).empty());
  EXPECT_FALSE(checker.verdict({0}, {1}).accepted);
}

TEST(MergeChecker, TakesOnlyWhatItAskedFor) {
  MergeChecker checker = a_check({});
  EXPECT_THROW(checker.add({kAgrees}), ContractViolation);
}

TEST(MergeChecker, ChanceJoinsMapsNoMoreOftenThanTheErrorRateSays) {
  // Tunnels that look alike go on agreeing half the time, by one of two looks; with an error rate that can be
  // counted.
  const double kEachLook = 1.0 - std::sqrt(0.5);
  MergeCheckConfig config;
  config.evidence.error_rate = 0.02;
  Rng rng(5);
  int num_wrong = 0;
  constexpr int kTrials = 2000;
  for (int trial = 0; trial < kTrials; ++trial) {
    MergeChecker checker = a_check(kTrueLoops, 0.5, config);
    num_wrong += run(checker, [&](const PlannedComparison&) {
                   return rng.uniform() < kEachLook ? kAgrees : kDiffers;
                 }).accepted;
  }
  EXPECT_LE(num_wrong, static_cast<int>(0.02 * kTrials));
  // And true alignments pass: one check in fifty differs.
  int num_right = 0;
  for (int trial = 0; trial < 200; ++trial) {
    MergeChecker checker = a_check(kTrueLoops);
    num_right += run(checker, [&](const PlannedComparison&) {
                   return rng.uniform() < 0.98 ? kAgrees : kDiffers;
                 }).accepted;
  }
  EXPECT_GE(num_right, 195);
}

}  // namespace
}  // namespace adit

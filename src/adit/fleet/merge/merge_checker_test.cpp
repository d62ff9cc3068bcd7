// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/merge_checker.hpp"

#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"
#include "adit/fleet/merge/merge_evidence.hpp"
#include "support/opposite_drives.hpp"

namespace adit {
namespace {

using test::along_x;
using test::kNum;
using test::kTrueLoops;
using test::loop_at;
using test::T_a_b_true;

// That go on with this chance, however long they have.
LookAlikes look_alikes(double chance_to_go_on) {
  constexpr int kSteps = 100'000;  // the prior of one half no longer shows
  LookAlikes out;
  if (chance_to_go_on != 0.5)
    for (int i = 0; i < kSteps; ++i) i < chance_to_go_on* kSteps ? out.add_agreed(0) : out.add_differed(0);
  return out;
}

// What was measured beforehand.
MeasuredWhenAsked measured(const LookAlikes& look_alikes, const EqualSignShares& walls = {}) {
  return [all = Measured{look_alikes, walls}]() -> const Measured& { return all; };
}

// Without walls, and no tunnel was built to the plan of another.
MergeCheckConfig by_places() {
  MergeCheckConfig config;
  config.relief = false;
  return config;
}

MergeChecker checker_of(const std::vector<PcmLoop>& loops, MeasuredWhenAsked measured,
                        const MergeCheckConfig& config = by_places(),
                        const OdometryChain& chain = along_x(kNum)) {
  AdaptiveConfig all;
  all.merge_check = config;
  const OdometryChain other = chain;  // another robot: the same chain twice would mean revisits
  return {{chain, other, loops}, {50.0, std::move(measured), {}}, all};
}

MergeChecker a_check(const std::vector<PcmLoop>& loops, double chance_to_go_on = 0.5,
                     const MergeCheckConfig& config = by_places()) {
  return checker_of(loops, measured(look_alikes(chance_to_go_on)), config);
}

// Answers all that the test asks for.
template <class Answer>
MergeCheck run(MergeChecker& checker, const Answer& answer) {
  for (std::vector<PlannedComparison> asked = checker.next(16); !asked.empty(); asked = checker.next(16)) {
    EXPECT_LE(asked.size(), 16U);
    std::vector<ComparedPlace> places;
    for (const PlannedComparison& check : asked) places.push_back(answer(check));
    checker.add(places);
  }
  return checker.verdict({0}, {1});
}

constexpr ComparedPlace kAgrees{0.5, true};
constexpr ComparedPlace kDiffers{1.5, true};
constexpr ComparedPlace kSilent{0.5, false};
constexpr ComparedPlace kHasANiche{5.0, true};

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

TEST(MergeChecker, SoManyLoopsHaveToAgreeWhateverThePlacesSay) {
  MergeCheckConfig three = by_places();
  three.min_loops = 3;
  const auto check = [](const MergeCheckConfig& config) {
    MergeChecker checker = a_check({loop_at(80), loop_at(100)}, 0.5, config);
    return run(checker, [](const PlannedComparison&) { return kAgrees; });
  };
  EXPECT_TRUE(check(by_places()).accepted);
  const MergeCheck too_few = check(three);
  EXPECT_FALSE(too_few.accepted);
  EXPECT_GT(too_few.evidence, too_few.needed);
  EXPECT_NE(too_few.reason.find("2 loops agree, 3 are needed"), std::string::npos) << too_few.reason;
}

TEST(Changes, CountAnObjectOnceHoweverOftenItIsSeen) {
  Changes things{5.0};
  EXPECT_TRUE(things.add({{10.0, 0.0, 0.0}, {40.0, 0.0, 0.0}}));
  EXPECT_TRUE(things.add({{12.0, 1.0, 0.0}, {43.0, -1.0, 0.0}, {20.0, 0.0, 0.0}}));
  EXPECT_EQ(things.num(), 3U);
  EXPECT_TRUE(things.know({{19.0, 0.0, 0.0}}));
  EXPECT_FALSE(things.know({{80.0, 0.0, 0.0}}));
  EXPECT_FALSE(things.know({})) << "a scan that cannot be compared shows no change that is known";
  EXPECT_EQ(things.num(), 4U);
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

TEST(MergeChecker, ThingsComeAndGo) {
  const MergeCheck none = check_with_things(1'000'000);
  const MergeCheck many = check_with_things(1);
  EXPECT_TRUE(many.accepted) << many.reason;
  EXPECT_NEAR(none.evidence - many.evidence, MergeCheckConfig().things_speak_at_most, 1e-9);
  EXPECT_EQ(check_with_things(40).evidence, none.evidence) << "a few are no evidence";
}

TEST(MergeEvidence, PoissonTail) {
  EXPECT_DOUBLE_EQ(poisson_tail(0, 2.0), 1.0);
  EXPECT_NEAR(poisson_tail(1, 2.0), 1.0 - std::exp(-2.0), 1e-12);
  EXPECT_NEAR(poisson_tail(3, 2.0), 1.0 - 5.0 * std::exp(-2.0), 1e-12);
  EXPECT_DOUBLE_EQ(poisson_tail(1, 0.0), 0.0);
}

// Patches of its own for each place, seen there twice; of so many in a hundred, spread over all, both offsets
// lie on one side.
ComparedPlace with_offsets(std::uint32_t theirs, int num_equal) {
  ComparedPlace place = kAgrees;
  for (int i = 0; i < 100; ++i)
    for (const double metres : {0.01, i % 10 * 10 + i / 10 < num_equal ? 0.01 : -0.01})
      place.offsets.push_back({{static_cast<int>(theirs), i, 0, 0}, metres});
  return place;
}

TEST(MergeChecker, WallsOnOneSideInAllScansAreOfOtherTunnels) {
  MergeCheckConfig without;
  without.relief = false;
  const auto check = [](int num_equal, const MergeCheckConfig& config) {
    MergeChecker checker = a_check(kTrueLoops, 0.5, config);
    return run(checker, [&](const PlannedComparison& c) { return with_offsets(c.theirs, num_equal); });
  };
  EXPECT_TRUE(check(50, {}).accepted);
  const MergeCheck built_alike = check(62, {});
  EXPECT_FALSE(built_alike.accepted);
  EXPECT_EQ(built_alike.hypotheses.front().outcome, HypothesisOutcome::refuted);
  EXPECT_NE(built_alike.reason.find("patches, 60 %"), std::string::npos) << built_alike.reason;
  EXPECT_TRUE(check(62, without).accepted);
}

TEST(MergeChecker, WallsCountWhereOwnLookAlikesHaveOthers) {
  const auto check = [&](int num_equal, double share_of_others) {
    EqualSignShares shares;
    for (int i = 0; i < 10; ++i) shares.add_other({1000, share_of_others, 0.015});
    MergeChecker checker = checker_of(kTrueLoops, measured(look_alikes(0.8), shares), {});
    return run(checker, [&](const PlannedComparison& c) { return with_offsets(c.theirs, num_equal); });
  };
  EXPECT_FALSE(check(50, 0.51).accepted) << "look-alikes go on for long, and their walls are the same";
  EXPECT_TRUE(check(50, 0.65).accepted);
  EXPECT_FALSE(check(60, 0.65).accepted);
}

// Few patches for each pair of scans: half of them, or all, on one side in both offsets.
ComparedPlace with_few_offsets(std::uint32_t theirs, bool all_equal) {
  ComparedPlace place = kAgrees;
  for (int i = 0; i < 6; ++i)
    for (const double metres : {0.01, all_equal || i % 2 == 0 ? 0.01 : -0.01})
      place.offsets.push_back({{static_cast<int>(theirs), i, 0, 0}, metres});
  return place;
}

TEST(MergeChecker, WhereLittleIsMissingMorePairsOfTheWallsDecide) {
  EqualSignShares shares;
  for (int i = 0; i < 10; ++i) shares.add_other({1000, 0.6, 0.015});
  MergeCheckConfig places_only;
  places_only.max_wall_checks = 0;
  std::size_t num_pairs = 0;
  const auto check = [&](const MergeCheckConfig& config, bool all_equal) {
    MergeChecker checker = checker_of(kTrueLoops, measured(look_alikes(0.865), shares), config);
    num_pairs = 0;
    return run(checker, [&](const PlannedComparison& c) {
      ++num_pairs;
      return with_few_offsets(c.theirs, all_equal && num_pairs > 33);
    });
  };
  const MergeCheck short_of_evidence = check(places_only, false);
  EXPECT_EQ(short_of_evidence.refused_kind, RefusalKind::too_little) << short_of_evidence.reason;
  EXPECT_EQ(num_pairs, short_of_evidence.num_checked);
  const MergeCheck decided = check({}, false);
  EXPECT_TRUE(decided.accepted) << decided.reason;
  EXPECT_GT(num_pairs, decided.num_checked);
  EXPECT_EQ(decided.num_checked, short_of_evidence.num_checked) << "the places stay the same";
  EXPECT_LT(num_pairs, 3U * decided.num_checked) << "no more than were needed";
  EXPECT_FALSE(check({}, true).accepted) << "other walls";
}

TEST(MergeEvidence, PlacesAloneDoNotTellATunnelFromOneBuiltToTheSamePlan) {
  EXPECT_NEAR(unless_copied(2.0, 5.0), 2.0, 0.1);
  EXPECT_NEAR(unless_copied(-20.0, 5.0), -20.0, 0.1);
  EXPECT_LT(unless_copied(30.0, 10.0), std::log(1.0 / kCopied) + 0.6);
  EXPECT_GT(unless_copied(100.0, 150.0), std::log(1e3)) << "but no plan was built twice all over";
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
  const double begins = std::log(kAgreementIfTrue / chance_to_go_on(rarely_begin.chances(), 0));
  const double goes_on = std::log(kAgreementIfTrue / chance_to_go_on(rarely_begin.chances(), 1));
  const double differs =
      std::log((1.0 - kAgreementIfTrue) / (1.0 - chance_to_go_on(rarely_begin.chances(), 1)));
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
  EXPECT_NEAR(agrees.evidence, agrees.num_checked * std::log(kAgreementIfTrue / 0.5), 1e-9);
  const MergeCheck differs = checked(true);
  EXPECT_EQ(differs.num_passed + 1, differs.num_checked);
}

TEST(MergeChecker, PlacesThatAgreeJoinTheMaps) {
  MergeChecker checker = a_check(kTrueLoops);
  const MergeCheck check = run(checker, [](const PlannedComparison&) { return kAgrees; });
  EXPECT_TRUE(check.accepted) << check.reason;
  EXPECT_EQ(check.num_passed, check.num_checked);
  EXPECT_NEAR(check.evidence, check.num_checked * std::log(kAgreementIfTrue / 0.5), 1e-9);
  EXPECT_NEAR(check.needed, std::log(1e3), 1e-9);
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

TEST(Hypothesis, ASecondLookThatAgreesIsNoSecondPairForTheWalls) {
  Hypothesis h;
  h.plan = {{10, 20, Pose()}};
  h.second_looks = {PlannedComparison{12, 22, Pose()}};
  h.wall_plan = {{12, 22, Pose()}, {14, 22, Pose()}, {14, 24, Pose()}};
  h.add(kDiffers);
  h.add_second_look(0, kAgrees);
  ASSERT_EQ(h.wall_plan.size(), 1U);
  EXPECT_EQ(h.wall_plan.front().theirs, 24U);
}

// A hypothesis of which one place differs, and what a second look at it showed.
Hypothesis looked_again(const ComparedPlace& first, const ComparedPlace& second) {
  Hypothesis h;
  h.plan.resize(2);
  h.second_looks = {PlannedComparison(), std::nullopt};
  h.add(first);
  h.add(kAgrees);
  EXPECT_EQ(h.to_look_at_again().size(), 1U);
  h.add_second_look(0, second);
  EXPECT_TRUE(h.is_finished());
  return h;
}

ComparedPlace differing(double difference, const std::vector<Vector3>& structures) {
  ComparedPlace place{difference, true};
  place.structures = structures;
  return place;
}

TEST(Hypothesis, ADifferenceThatASecondLookDoesNotFindThereAgainIsChance) {
  const std::vector<Vector3> here = {{10.0, 2.0, 1.0}};
  const std::vector<Vector3> elsewhere = {{30.0, 2.0, 1.0}};
  const Hypothesis found_again = looked_again(differing(2.0, here), differing(2.0, here));
  EXPECT_EQ(found_again.num_changes(), 1U);
  EXPECT_EQ(found_again.num_agreeing(), 1U);
  const Hypothesis by_chance = looked_again(differing(2.0, here), differing(2.0, elsewhere));
  EXPECT_EQ(by_chance.num_changes(), 0U);
  EXPECT_EQ(by_chance.num_agreeing(), 2U);
  const Hypothesis gross = looked_again(differing(20.0, here), differing(20.0, elsewhere));
  EXPECT_EQ(gross.num_changes(), 1U) << "no chance makes so much of it";
  const Hypothesis nothing_in_common = looked_again(differing(1e9, {}), differing(1e9, {}));
  EXPECT_EQ(nothing_in_common.num_changes(), 1U);
}

TEST(Hypothesis, BesideAKnownChangeAPlaceStaysDistinctiveByWhatShowsElsewhere) {
  const Vector3 change(10.0, 2.0, 1.0);
  const auto outcome_by = [&](const DisplacementSigns& signs) {
    Hypothesis h;
    h.plan.resize(2);
    h.second_looks.resize(2);
    ComparedPlace place = differing(2.0, {change});
    place.signs = signs;
    h.add(place);
    h.add(place);
    EXPECT_EQ(h.num_changes(), 1U);
    return h.places(true).back().outcome;
  };
  const Vector3 near = change + Vector3(3.0, 0.0, 0.0);
  const Vector3 far = change + Vector3(30.0, 0.0, 0.0);
  EXPECT_EQ(outcome_by({{far}, {near, far}}), PlaceOutcome::distinctive);
  EXPECT_EQ(outcome_by({{far}, {near}}), PlaceOutcome::agrees) << "one way only the change shows";
  EXPECT_EQ(outcome_by({}), PlaceOutcome::agrees);
}

TEST(MergeChecker, WhereEveryPlaceShowsOneChangeNothingSpeaksForAMerge) {
  const MergeCheck one = check_with_structures(1, 0.0);
  EXPECT_FALSE(one.accepted);
  EXPECT_EQ(one.hypotheses.at(0).outcome, HypothesisOutcome::refuted);
}

TEST(MergeChecker, ARefutedHypothesisIsNotTestedToTheEnd) {
  MergeChecker checker = a_check(kTrueLoops);
  const MergeCheck check = run(checker, [](const PlannedComparison&) { return kDiffers; });
  EXPECT_FALSE(check.accepted);
  EXPECT_EQ(check.num_checked, 8U);
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
  MergeCheckConfig all_count = by_places();
  all_count.distinctive_only = false;
  MergeChecker other = a_check(kTrueLoops, 0.5, all_count);
  EXPECT_TRUE(run(other, [](const PlannedComparison&) { return kSilent; }).accepted);
}

TEST(MergeChecker, WhereLookAlikesGoOnForLongALongerStretchIsNeeded) {
  MergeChecker checker = a_check(kTrueLoops, 0.9);
  const MergeCheck check = run(checker, [](const PlannedComparison&) { return kAgrees; });
  EXPECT_FALSE(check.accepted);
  EXPECT_EQ(check.hypotheses.at(0).outcome, HypothesisOutcome::unsure);
  // Every further 3 m bring log(0.99 / 0.9); what is missing, rounded up to 10 m.
  const double metres = 3.0 * std::ceil((check.needed - check.evidence) / std::log(kAgreementIfTrue / 0.9));
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

TEST(MergeChecker, TwoHypothesesWithTheSameSupportDecideNothing) {
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

TEST(MergeChecker, RivalsToEitherSideOfTheFirstAreAsFarApartAsTheyAre) {
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

TEST(MergeChecker, AHypothesisFarBehindTheBestIsNoRival) {
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

// The kind of difference, and whether more evidence would decide.
struct Told {
  MergeCheck check;
  bool is_undecided;
};
template <class Answer>
Told told(const std::vector<PcmLoop>& loops, double chance_to_go_on, const Answer& answer,
          const MergeCheckConfig& config = by_places()) {
  MergeChecker checker = a_check(loops, chance_to_go_on, config);
  const MergeCheck check = run(checker, answer);
  return {check, checker.undecided().has_value()};
}

TEST(MergeRefusal, SaysWhatKindOfDifferenceItIs) {
  const auto expect = [](const Told& found, RefusalKind kind, bool is_undecided) {
    EXPECT_FALSE(found.check.accepted);
    EXPECT_EQ(found.check.refused_kind, kind) << found.check.reason;
    EXPECT_EQ(found.is_undecided, is_undecided) << found.check.reason;
    EXPECT_NE(found.check.reason.find("; "), std::string::npos) << "a remedy: " << found.check.reason;
  };
  const auto always = [](const ComparedPlace& place) {
    return [=](const PlannedComparison&) { return place; };
  };
  expect(told({}, 0.5, always(kAgrees)), RefusalKind::no_loop, false);
  expect(told(kTrueLoops, 0.5, always(kDiffers)), RefusalKind::other_tunnel, false);
  expect(told(kTrueLoops, 0.9, always(kAgrees)), RefusalKind::too_little, true);
  expect(told(kTrueLoops, 0.5, always(kSilent)), RefusalKind::too_little, true);
  std::vector<PcmLoop> loops = kTrueLoops;
  for (const std::size_t a : {70U, 120U, 130U}) loops.push_back(loop_at(a, 20.0));
  expect(told(loops, 0.5, always(kAgrees)), RefusalKind::rival, true);
  const Told merged = told(kTrueLoops, 0.5, always(kAgrees));
  EXPECT_EQ(merged.check.refused_kind, RefusalKind::unknown);
  EXPECT_FALSE(merged.is_undecided);
}

// Structure of its own at every so many-th place, by both looks.
MergeCheck check_of_changes(std::uint32_t every, double chance_to_go_on) {
  MergeCheckConfig config;
  config.error_rate = 0.05;  // the stretch is short
  MergeChecker checker = a_check(kTrueLoops, chance_to_go_on, config);
  const std::uint32_t first = checker.next(1).front().own % 6;
  return run(checker, [&](const PlannedComparison& asked) {
    const std::uint32_t place_number = (asked.own + 3 - first) / 6;
    if (place_number % every != 0) return kAgrees;
    ComparedPlace place = kHasANiche;
    place.structures = {{20.0 * place_number, 0.0, 0.0}};
    return place;
  });
}

TEST(MergeRefusal, ChangesAmongPlacesThatAgreeAreNoOtherTunnel) {
  EXPECT_EQ(check_of_changes(1, 0.5).refused_kind, RefusalKind::other_tunnel);
  EXPECT_EQ(check_of_changes(2, 0.5).refused_kind, RefusalKind::changed_or_other);
  const MergeCheck often = check_of_changes(4, 0.5);
  EXPECT_NE(often.reason.find("scans differ at 9 of 34 places"), std::string::npos) << often.reason;
  EXPECT_NE(often.reason.find("the others speak for one tunnel"), std::string::npos) << often.reason;
  const MergeCheck seldom = check_of_changes(5, 0.5);
  EXPECT_NE(seldom.reason.find("evidence"), std::string::npos) << seldom.reason;
  EXPECT_NE(seldom.reason.find("which speaks for one tunnel that has changed"), std::string::npos)
      << seldom.reason;
  for (const MergeCheck& changed : {often, seldom}) {
    EXPECT_FALSE(changed.accepted);
    EXPECT_EQ(changed.refused_kind, RefusalKind::changed_place);
  }
  EXPECT_EQ(check_of_changes(4, 0.8).refused_kind, RefusalKind::changed_or_other)
      << "where own look-alikes agree as often, too";
  EXPECT_EQ(check_of_changes(6, 0.85).refused_kind, RefusalKind::changed_or_other);
  EXPECT_TRUE(check_of_changes(12, 0.5).accepted);
}

TEST(MergeRefusal, ThingsAloneMayKeepMapsApart) {
  const auto things_everywhere = [](const PlannedComparison& asked) {
    ComparedPlace place = kAgrees;
    place.things.emplace_back(9.0 * asked.theirs, 0.0, 0.0);
    return place;
  };
  // Look-alikes that go on so often that things tip the scales, whatever number of places there is.
  bool is_found = false;
  for (double chance = 0.5; chance < 0.95; chance += 0.01) {
    const Told with = told(kTrueLoops, chance, things_everywhere);
    const Told without = told(kTrueLoops, chance, [](const PlannedComparison&) { return kAgrees; });
    if (with.check.accepted) continue;
    EXPECT_EQ(with.check.refused_kind,
              without.check.accepted ? RefusalKind::changed_place : RefusalKind::too_little)
        << with.check.reason;
    is_found |= without.check.accepted;
  }
  EXPECT_TRUE(is_found);
}

// Walls of another relief, and all of them farther off by what an error of range may be.
Told told_of_walls(double range_error_m) {
  return told(
      kTrueLoops, 0.5,
      [=](const PlannedComparison& asked) {
        ComparedPlace place = kAgrees;
        for (int i = 0; i < 100; ++i) {
          const double metres = i % 2 == 0 ? 0.01 : -0.01;
          for (const double offset : {metres, i % 10 < 7 ? metres : -metres}) {
            place.offsets.push_back({{static_cast<int>(asked.theirs), i, 0, 0}, offset + range_error_m});
            place.offsets.back().terms[0] = 1.0;
          }
        }
        return place;
      },
      MergeCheckConfig());
}

TEST(MergeRefusal, WallsThatSensorsMayMoveAreNotSaidToBeOfAnotherTunnel) {
  EXPECT_EQ(told_of_walls(0.0).check.refused_kind, RefusalKind::other_tunnel);
  const MergeCheck off = told_of_walls(0.03).check;
  EXPECT_EQ(off.refused_kind, RefusalKind::sensor);
  EXPECT_NE(off.reason.find("it may be the sensors"), std::string::npos) << off.reason;
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
  config.error_rate = 0.02;
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

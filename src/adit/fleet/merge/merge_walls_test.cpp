// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// What the relief of walls does in a merge check.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "adit/fleet/merge/merge_checker.hpp"
#include "support/merge_checks.hpp"

namespace adit {
namespace {

using test::a_check;
using test::agreeing_with_relief;
using test::checker_of;
using test::kAgrees;
using test::kDiffers;
using test::kNum;
using test::kTrueLoops;
using test::look_alikes;
using test::loop_at;
using test::measured;
using test::run;

// Patches of its own for each place, seen there twice; of so many in a hundred, spread over all, both offsets
// lie on one side.
ComparedPlace with_offsets(std::uint32_t theirs, int num_equal) {
  ComparedPlace place = kAgrees;
  for (int i = 0; i < 100; ++i)
    for (const double metres : {0.01, i % 10 * 10 + i / 10 < num_equal ? 0.01 : -0.01})
      place.offsets.push_back({{static_cast<int>(theirs), i, 0, 0}, metres});
  return place;
}

TEST(MergeWalls, WallsOnOneSideInAllScansAreOfOtherTunnels) {
  MergeCheckConfig without;
  without.relief = false;
  const auto check = [](int num_equal, const MergeCheckConfig& config) {
    MergeChecker checker = a_check(kTrueLoops, 0.5, config);
    return run(checker, [&](const PlannedComparison& c) { return with_offsets(c.theirs, num_equal); });
  };
  EXPECT_TRUE(check(50, {}).accepted);
  const MergeCheck built_alike = check(62, {});
  EXPECT_FALSE(built_alike.accepted);
  EXPECT_EQ(built_alike.hypotheses.front().outcome, HypothesisOutcome::unsure);
  EXPECT_NE(built_alike.reason.find("patches, 62 %"), std::string::npos) << built_alike.reason;
  EXPECT_TRUE(check(62, without).accepted);
}

// Copies agree at all places. The walls show between the places of the plan alone.
TEST(MergeWalls, NoneIsAcceptedBeforeItsWallsWereSeen) {
  MergeCheckConfig without;
  without.max_wall_checks = 0;
  std::set<std::uint32_t> places;
  MergeChecker first = a_check(kTrueLoops, 0.5, without);
  const MergeCheck unseen = run(first, [&](const PlannedComparison& asked) {
    places.insert(asked.theirs);
    return kAgrees;
  });
  ASSERT_TRUE(unseen.accepted) << "there are no more pairs of walls: " << unseen.reason;
  for (const int num_equal : {50, 80}) {
    MergeChecker checker = a_check(kTrueLoops, 0.5, {});
    const MergeCheck check = run(checker, [&](const PlannedComparison& asked) {
      return places.contains(asked.theirs) ? kAgrees : with_offsets(asked.theirs, num_equal);
    });
    EXPECT_GT(check.hypotheses.front().counts.num_wall_patches, 0U);
    EXPECT_EQ(check.accepted, num_equal == 50) << check.reason;
  }
}

// Another alignment, 20 m off, differs at every third place, so that it is neither refuted nor a rival. The
// walls of the best one are the same; `own` are those of look-alikes.
MergeCheck with_another_alignment(double relief_elsewhere_m, const EqualSignShares& own,
                                  const MergeCheckConfig& config = {}) {
  std::vector<PcmLoop> loops = kTrueLoops;
  for (const std::size_t a : {70U, 120U}) loops.push_back(loop_at(a, 20.0));
  MergeChecker checker = checker_of(loops, measured(look_alikes(0.7), own), config);
  return run(checker, [&](const PlannedComparison& asked) {
    const bool is_elsewhere = asked.own + asked.theirs > kNum + 20;
    if (!is_elsewhere) return agreeing_with_relief(asked.theirs, 0.0);
    if (asked.question == PlaceQuestion::walls) return agreeing_with_relief(asked.theirs, relief_elsewhere_m);
    return asked.theirs / 6 % 3 == 0 ? kDiffers : kAgrees;
  });
}

TEST(MergeWalls, WallsThatAreTheSameAtAnotherAlignmentTooSayLittle) {
  EqualSignShares own;
  for (int i = 0; i < 5; ++i) own.add_other({1000, 0.65, 0.015});
  const MergeCheck others = with_another_alignment(0.01, own);
  const MergeCheck one_mould = with_another_alignment(0.0, own);
  ASSERT_EQ(others.hypotheses.size(), 2U);
  EXPECT_GT(one_mould.hypotheses.back().counts.num_wall_patches, 100U);
  EXPECT_LT(one_mould.hypotheses.front().walls, others.hypotheses.front().walls - 1.0);
  EXPECT_EQ(one_mould.hypotheses.front().loops, others.hypotheses.front().loops);
}

TEST(MergeWalls, WallsOfAnotherAlignmentMayGiveWhatIsMissing) {
  MergeCheckConfig unreachable;
  unreachable.evidence.error_rate = 1e-12;
  const MergeCheck before = with_another_alignment(0.01, {}, unreachable);
  EXPECT_EQ(before.hypotheses.back().counts.num_wall_patches, 0U) << "they could not give as much";
  MergeCheckConfig within_reach;
  within_reach.evidence.error_rate = std::exp(-(before.hypotheses.front().evidence + 0.3));
  const MergeCheck others = with_another_alignment(0.01, {}, within_reach);
  EXPECT_TRUE(others.accepted) << others.reason;
  EXPECT_GT(others.hypotheses.back().counts.num_wall_patches, 50U);
  const MergeCheck one_mould = with_another_alignment(0.0, {}, within_reach);
  EXPECT_FALSE(one_mould.accepted);
  EXPECT_LT(one_mould.hypotheses.front().evidence, before.hypotheses.front().evidence);
}

TEST(MergeWalls, WallsCountWhereOwnLookAlikesHaveOthers) {
  const auto check = [&](int num_equal, double share_of_others) {
    EqualSignShares shares;
    for (int i = 0; i < 10; ++i) shares.add_other({1000, share_of_others, 0.015});
    MergeChecker checker = checker_of(kTrueLoops, measured(look_alikes(0.85), shares), {});
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

TEST(MergeWalls, WhereLittleIsMissingMorePairsOfTheWallsDecide) {
  EqualSignShares shares;
  for (int i = 0; i < 10; ++i) shares.add_other({1000, 0.56, 0.015});
  MergeCheckConfig places_only;
  places_only.max_wall_checks = 0;
  constexpr std::size_t kPlaces = 34;  // along the whole drive
  std::size_t num_pairs = 0;
  const auto check = [&](const MergeCheckConfig& config, bool all_equal) {
    MergeChecker checker = checker_of(kTrueLoops, measured(look_alikes(0.84), shares), config);
    num_pairs = 0;
    return run(checker, [&](const PlannedComparison& c) {
      ++num_pairs;  // first the places, then what lies between them
      return with_few_offsets(c.theirs, all_equal && num_pairs > kPlaces);
    });
  };
  const MergeCheck short_of_evidence = check(places_only, false);
  EXPECT_EQ(short_of_evidence.refused_kind, RefusalKind::too_little) << short_of_evidence.reason;
  EXPECT_EQ(num_pairs, kPlaces);
  const MergeCheck decided = check({}, false);
  EXPECT_TRUE(decided.accepted) << decided.reason;
  EXPECT_EQ(decided.num_checked, kPlaces) << "the places stay the same";
  EXPECT_GT(num_pairs, kPlaces);
  EXPECT_LT(num_pairs, 3 * kPlaces) << "no more than were needed";
  EXPECT_FALSE(check({}, true).accepted) << "other walls";
}

}  // namespace
}  // namespace adit

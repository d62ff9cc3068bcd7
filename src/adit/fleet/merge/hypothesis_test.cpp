// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/hypothesis.hpp"

#include <gtest/gtest.h>

#include "support/merge_checks.hpp"

namespace adit {
namespace {

using test::kAgrees;
using test::kDiffers;

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

TEST(Hypothesis, APlaceIsThatOfItsSecondLookWhereThatAgreed) {
  Hypothesis h;
  h.plan = {{10, 110, Pose()}, {20, 120, Pose()}};
  h.second_looks = {std::nullopt, PlannedComparison{22, 122, Pose()}};
  h.add(kAgrees);
  h.add(kDiffers);
  h.add_second_look(1, kAgrees);
  const std::vector<TestedPlace> places = h.places();
  ASSERT_EQ(places.size(), 2U);
  EXPECT_EQ(places[1].a, 22U);
  EXPECT_EQ(places[1].b, 122U);
  EXPECT_EQ(places[1].outcome, PlaceOutcome::distinctive);
}

ComparedPlace in_dust(ComparedPlace place, const std::optional<float>& own,
                      const std::optional<float>& theirs) {
  place.unconfirmed_own = own;
  place.unconfirmed_theirs = theirs;
  return place;
}

TEST(Hypothesis, UnconfirmedSharesAreThoseOfTheScansThatWereJudged) {
  Hypothesis h;
  EXPECT_FALSE(h.unconfirmed().a || h.unconfirmed().b);
  h.plan.resize(3);
  h.second_looks.resize(3);
  h.second_looks[1] = PlannedComparison();
  h.add(in_dust(kAgrees, 0.25F, {}));
  h.add(in_dust(kDiffers, 0.75F, {}));
  h.add(in_dust(kAgrees, {}, {}));
  EXPECT_EQ(h.unconfirmed().a, 0.5);
  EXPECT_FALSE(h.unconfirmed().b);
  h.add_second_look(1, in_dust(kAgrees, 0.5F, 0.125F));
  EXPECT_EQ(h.unconfirmed().a, 0.375) << "of the scans that agree, in place of those that did not";
  EXPECT_EQ(h.unconfirmed().b, 0.125);
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
    h.add(place);
    h.add(place);
    EXPECT_EQ(h.num_changes(), 1U);
    EXPECT_EQ(h.to_ask_for_signs(), std::vector<std::size_t>{1}) << "of the place that has nothing else";
    place.signs = signs;
    h.add_signs(1, place);
    EXPECT_TRUE(h.to_ask_for_signs().empty());
    return h.places().back().outcome;
  };
  const Vector3 near = change + Vector3(3.0, 0.0, 0.0);
  const Vector3 far = change + Vector3(30.0, 0.0, 0.0);
  EXPECT_EQ(outcome_by({{far}, {near, far}}), PlaceOutcome::distinctive);
  EXPECT_EQ(outcome_by({{far}, {near}}), PlaceOutcome::agrees) << "one way only the change shows";
  EXPECT_EQ(outcome_by({}), PlaceOutcome::agrees);
}

TEST(Hypothesis, WallsCountBesideChangesThatAreKnownAlone) {
  const Vector3 change(10.0, 2.0, 1.0);
  const auto num_patches_beside = [&](double difference, const std::vector<Vector3>& structures) {
    Hypothesis h;
    h.plan.resize(1);
    h.second_looks.resize(1);
    h.add(differing(2.0, {change}));
    ComparedPlace pair = test::agreeing_with_relief(1, 0.0);
    pair.difference = difference;
    pair.structures = structures;
    h.add_walls(pair);
    EXPECT_EQ(h.num_walls_compared, 1U);
    return h.offsets.counted().num_patches;
  };
  EXPECT_GT(num_patches_beside(0.5, {}), 50U);
  EXPECT_GT(num_patches_beside(2.0, {change + Vector3(2.0, 0.0, 0.0)}), 50U);
  EXPECT_EQ(num_patches_beside(2.0, {change, change + Vector3(40.0, 0.0, 0.0)}), 0U) << "one more change";
  EXPECT_EQ(num_patches_beside(1e9, {}), 0U) << "nothing in common";
}

}  // namespace
}  // namespace adit

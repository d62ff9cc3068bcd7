// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "adit/fleet/merge/merge_checker.hpp"
#include "adit/fleet/merge/merge_evidence.hpp"
#include "support/merge_checks.hpp"

namespace adit {
namespace {

using test::a_check;
using test::by_places;
using test::kAgrees;
using test::kDiffers;
using test::kHasANiche;
using test::kSilent;
using test::kTrueLoops;
using test::loop_at;
using test::run;

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

// What driving on would be worth is counted as the check counts: tunnels built to one plan bound it.
TEST(MergeRefusal, WhatMorePlacesWouldBeWorthIsWhatTheCheckWouldCount) {
  MergeCheckConfig with_relief;
  with_relief.evidence.error_rate = 1e-6;
  MergeChecker checker = a_check(kTrueLoops, 0.5, with_relief);
  const MergeCheck check = run(checker, [](const PlannedComparison&) { return kAgrees; });
  ASSERT_FALSE(check.accepted);
  const std::optional<UndecidedStretch> undecided = checker.undecided();
  ASSERT_TRUE(undecided);
  EXPECT_NEAR(undecided->evidence(undecided->places), check.evidence, 1e-12);
  std::vector<TestedPlace> more = undecided->places;
  for (std::uint32_t k = 0; k < 100; ++k) more.push_back({1000 + k, 0, PlaceOutcome::distinctive});
  EXPECT_LT(undecided->evidence(more),
            -std::log(kFleetEvidence.copied * copied_to_true(more.size(), 0)) + 1e-9);
  EXPECT_GT(undecided->evidence(more), check.evidence);
}

// Structure of its own at every so many-th place, by both looks.
MergeCheck check_of_changes(std::uint32_t every, double chance_to_go_on,
                            const std::optional<float>& own_dust = {},
                            const std::optional<float>& their_dust = {}) {
  MergeCheckConfig config;
  config.evidence.error_rate = 0.05;  // the stretch is short
  MergeChecker checker = a_check(kTrueLoops, chance_to_go_on, config);
  const std::uint32_t first = checker.next(1).front().own % 6;
  return run(checker, [&](const PlannedComparison& asked) {
    const std::uint32_t place_number = (asked.own + 3 - first) / 6;
    ComparedPlace place = place_number % every != 0 ? kAgrees : kHasANiche;
    if (place_number % every == 0) place.structures = {{20.0 * place_number, 0.0, 0.0}};
    place.unconfirmed_own = own_dust;
    place.unconfirmed_theirs = their_dust;
    return place;
  });
}

TEST(MergeRefusal, ChangesAmongPlacesThatAgreeAreNoOtherTunnel) {
  EXPECT_EQ(check_of_changes(1, 0.5).refused_kind, RefusalKind::other_tunnel);
  EXPECT_EQ(check_of_changes(2, 0.5).refused_kind, RefusalKind::changed_or_other);
  const MergeCheck often = check_of_changes(3, 0.4);
  EXPECT_NE(often.reason.find("scans differ at 12 of 34 places"), std::string::npos) << often.reason;
  EXPECT_NE(often.reason.find("the others speak for one tunnel"), std::string::npos) << often.reason;
  const MergeCheck seldom = check_of_changes(4, 0.5);
  EXPECT_NE(seldom.reason.find("evidence"), std::string::npos) << seldom.reason;
  EXPECT_NE(seldom.reason.find("which speaks for one tunnel that has changed"), std::string::npos)
      << seldom.reason;
  for (const MergeCheck& changed : {often, seldom}) {
    EXPECT_FALSE(changed.accepted);
    EXPECT_EQ(changed.refused_kind, RefusalKind::changed_place);
  }
  EXPECT_EQ(check_of_changes(3, 0.8).refused_kind, RefusalKind::changed_or_other)
      << "where own look-alikes agree as often, too";
  EXPECT_EQ(check_of_changes(6, 0.85).refused_kind, RefusalKind::changed_or_other);
  EXPECT_TRUE(check_of_changes(12, 0.5).accepted);
}

// Walls of another relief, and all of them farther off by what an error of range may be.
Told told_of_walls(double range_error_m, const std::optional<float>& own_dust = {}) {
  return told(
      kTrueLoops, 0.5,
      [=](const PlannedComparison& asked) {
        ComparedPlace place = test::agreeing_with_relief(asked.theirs, 0.01, range_error_m);
        place.unconfirmed_own = own_dust;
        return place;
      },
      MergeCheckConfig());
}

TEST(MergeRefusal, WallsThatSensorsMayMoveAreNotSaidToBeOfAnotherTunnel) {
  const Told other = told_of_walls(0.0);
  EXPECT_EQ(other.check.refused_kind, RefusalKind::changed_or_other);
  EXPECT_TRUE(other.is_undecided) << "more of the same stretch would tell";
  const MergeCheck off = told_of_walls(0.03).check;
  EXPECT_EQ(off.refused_kind, RefusalKind::sensor);
  EXPECT_NE(off.reason.find("it may be the sensors"), std::string::npos) << off.reason;
}

TEST(MergeRefusal, DustIsToldWhereItMayHaveMadeTheDifferenceAndDecidesNothing) {
  const auto tells_dust = [](const MergeCheck& check) {
    return check.reason.find("confirmed by no other return") != std::string::npos;
  };
  for (const std::uint32_t every : {3U, 4U}) {  // scans differ too often, or leave too little evidence
    const double chance_to_go_on = every == 3 ? 0.4 : 0.5;
    const MergeCheck clear = check_of_changes(every, chance_to_go_on);
    const MergeCheck dusty = check_of_changes(every, chance_to_go_on, 0.0625F, 0.21875F);
    EXPECT_EQ(dusty.unconfirmed.a, 0.0625);
    EXPECT_EQ(dusty.unconfirmed.b, 0.21875);
    EXPECT_FALSE(clear.unconfirmed.a || clear.unconfirmed.b);
    EXPECT_FALSE(tells_dust(clear));
    EXPECT_NE(dusty.reason.find("; of the scans compared, 6 % and 22 % of the returns were confirmed by no "
                                "other return"),
              std::string::npos)
        << dusty.reason;
    EXPECT_NE(dusty.reason.find("when it has settled; "), std::string::npos) << dusty.reason;
    EXPECT_EQ(dusty.refused_kind, RefusalKind::changed_place);
    EXPECT_EQ(dusty.evidence, clear.evidence);
    EXPECT_FALSE(tells_dust(check_of_changes(every, chance_to_go_on, 0.04F, 0.03F)));
  }
  EXPECT_FALSE(tells_dust(check_of_changes(1, 0.5, 0.25F, 0.25F))) << "another tunnel";
  const MergeCheck sensor = told_of_walls(0.03, 0.25F).check;
  EXPECT_EQ(sensor.refused_kind, RefusalKind::sensor);
  EXPECT_NE(sensor.reason.find("25 % of the first robot's returns were"), std::string::npos) << sensor.reason;
}

}  // namespace
}  // namespace adit

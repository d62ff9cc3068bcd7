// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Alignments that few loops suggest.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <vector>

#include "adit/fleet/merge/merge_checker.hpp"
#include "support/merge_checks.hpp"

namespace adit {
namespace {

using test::a_check;
using test::by_places;
using test::kAgrees;
using test::kNum;
using test::kTrueLoops;
using test::loop_at;
using test::run;

TEST(FewLoops, SpeakAgainstAnAlignmentAndManyForNone) {
  const auto evidence_of = [](const std::vector<PcmLoop>& loops, double few) {
    MergeCheckConfig config = by_places();
    config.evidence.few_loops = few;
    MergeChecker checker = a_check(loops, 0.5, config);
    return run(checker, [](const PlannedComparison&) { return kAgrees; }).evidence;
  };
  const EvidenceModel model;
  const std::vector<PcmLoop> two = {loop_at(80), loop_at(90)};
  EXPECT_NEAR(evidence_of(two, 2.0) - evidence_of(two, 1.0),
              std::log(model.few_loops_if_true / model.few_loops_if_false), 1e-9);
  EXPECT_EQ(evidence_of(kTrueLoops, 2.0), evidence_of(kTrueLoops, 1.0));
}

// What came of looking again for an alignment of two loops, where `missing` more evidence is needed than it
// has.
struct LookedForAgain {
  MergeCheck check;
  std::vector<PlannedComparison> asked;
};
LookedForAgain looked_for_again(FoundAgain found, double missing, MergeCheckConfig config = by_places(),
                                const std::vector<PcmLoop>& loops = {loop_at(80), loop_at(90)}) {
  LookedForAgain out;
  const auto compared = [&](const PlannedComparison& asked) {
    ComparedPlace place = kAgrees;
    if (asked.question != PlaceQuestion::registration) return place;
    out.asked.push_back(asked);
    place.found_again = found;
    return place;
  };
  config.evidence.error_rate = 0.5;
  MergeChecker easy = a_check(loops, 0.5, config);
  config.evidence.error_rate = std::exp(-run(easy, compared).evidence - missing);
  out.asked.clear();
  MergeChecker checker = a_check(loops, 0.5, config);
  out.check = run(checker, compared);
  return out;
}

TEST(FewLoops, AreForgivenWhereTheAlignmentIsFoundAgain) {
  const auto [check, asked] = looked_for_again(FoundAgain::there, 1.0);
  EXPECT_TRUE(check.accepted) << check.reason;
  EXPECT_EQ(check.loops.size(), 2U) << "what was found again joins no maps itself";
  const HypothesisCounts& counts = check.hypotheses.front().counts;
  EXPECT_EQ(counts.num_looked_for, asked.size());
  EXPECT_EQ(counts.num_found_again, asked.size());
  ASSERT_EQ(asked.size(), static_cast<std::size_t>(MergeCheckConfig().max_found_again));
  // Along all of it, and not where the loops are.
  EXPECT_LT(asked.front().theirs, 40U);
  EXPECT_GT(asked.back().theirs, kNum - 40U);
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const auto at = static_cast<int>(asked[i].theirs);
    for (const std::size_t b : {loop_at(80).b, loop_at(90).b})
      EXPECT_GE(std::abs(at - static_cast<int>(b)), 6);
    EXPECT_TRUE(i == 0 || at >= static_cast<int>(asked[i - 1].theirs) + 6);
  }
}

TEST(FewLoops, AreNotForgivenWhereItIsNotFoundAgain) {
  for (const FoundAgain found : {FoundAgain::elsewhere, FoundAgain::slides}) {
    const MergeCheck check = looked_for_again(found, 1.0).check;
    EXPECT_FALSE(check.accepted);
    EXPECT_NEAR(check.needed - check.evidence, 1.0, 1e-9);
    EXPECT_EQ(check.hypotheses.front().counts.num_found_again, 0U);
  }
}

TEST(FewLoops, AreForgivenOnlyIfMoreIsFoundThanNot) {
  for (const int of_three : {1, 2}) {
    int num = 0;
    const std::vector<PcmLoop> two = {loop_at(80), loop_at(90)};
    const auto compared = [&](const PlannedComparison& asked) {
      ComparedPlace place = kAgrees;
      if (asked.question == PlaceQuestion::registration)
        place.found_again = num++ % 3 < of_three ? FoundAgain::there : FoundAgain::elsewhere;
      return place;
    };
    MergeCheckConfig config = by_places();
    MergeChecker easy = a_check(two, 0.5, config);
    config.evidence.error_rate = std::exp(-run(easy, compared).evidence - 1.0);
    MergeChecker checker = a_check(two, 0.5, config);
    num = 0;
    EXPECT_EQ(run(checker, compared).accepted, of_three == 2);
    EXPECT_EQ(num, MergeCheckConfig().max_found_again) << "all are looked for";
  }
}

TEST(FewLoops, NothingIsLookedForAgainWhereItWouldNotDecide) {
  EXPECT_TRUE(looked_for_again(FoundAgain::there, 5.0).asked.empty()) << "too much is missing";
  EXPECT_TRUE(looked_for_again(FoundAgain::there, -1.0).asked.empty()) << "nothing is missing";
  EXPECT_TRUE(looked_for_again(FoundAgain::there, 1.0, by_places(), kTrueLoops).asked.empty());
  MergeCheckConfig none = by_places();
  none.max_found_again = 0;
  EXPECT_TRUE(looked_for_again(FoundAgain::there, 1.0, none).asked.empty());
}

}  // namespace
}  // namespace adit

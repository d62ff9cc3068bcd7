// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Alignments that few loops suggest.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "adit/fleet/merge/merge_checker.hpp"
#include "support/merge_checks.hpp"

namespace adit {
namespace {

using test::a_check;
using test::by_places;
using test::kAgrees;
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

TEST(FewLoops, AreRefusedWhereTheyLackWhatManyWouldHave) {
  const std::vector<PcmLoop> two = {loop_at(80), loop_at(90)};
  const auto agrees = [](const PlannedComparison& asked) {
    EXPECT_EQ(asked.question, PlaceQuestion::agreement);
    return kAgrees;
  };
  MergeCheckConfig config = by_places();
  MergeChecker easy = a_check(two, 0.5, config);
  config.evidence.error_rate = std::exp(-run(easy, agrees).evidence - 1.0);
  MergeChecker checker = a_check(two, 0.5, config);
  const MergeCheck check = run(checker, agrees);
  EXPECT_FALSE(check.accepted);
  EXPECT_NEAR(check.needed - check.evidence, 1.0, 1e-9);
  MergeChecker many = a_check(kTrueLoops, 0.5, config);
  EXPECT_TRUE(run(many, agrees).accepted);
}

}  // namespace
}  // namespace adit

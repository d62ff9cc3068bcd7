// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/loop_account.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

LoopOutcome outcome_of(std::uint32_t a, std::uint32_t b, bool is_selected, double weight) {
  LoopOutcome outcome;
  outcome.loop.from = {{0}, a};
  outcome.loop.to = {{1}, b};
  outcome.loop.verdict = LoopVerdict::accepted;
  outcome.loop.reason = "70 inliers";
  outcome.is_selected = is_selected;
  outcome.weight = weight;
  return outcome;
}

FleetSolution pair_with(std::size_t clique, const std::string& refused_reason) {
  FleetSolution solution;
  PairOutcome& pair = solution.pairs.emplace_back();
  pair.a = {0};
  pair.b = {1};
  pair.num_selected = clique;
  pair.merged = refused_reason.empty();
  pair.refused_reason = refused_reason;
  return solution;
}

/// Five hypotheses of one loop each, (0, 0) to (4, 4), one of every outcome that the best one leaves
/// possible.
FleetGraph tested(HypothesisOutcome best) {
  FleetGraph fleet;
  MergeCheck& check = fleet.checks[{{0}, {1}}];
  check.needed = 9.2;
  check.accepted = best == HypothesisOutcome::accepted;
  check.hypotheses = {{best, 5.0, 20, 19, 0.0, {{0, 0}}},
                      {HypothesisOutcome::rival, 4.5, 20, 18, 21.0, {{1, 1}}},
                      {HypothesisOutcome::behind, -8.0, 20, 18, 33.0, {{2, 2}}},
                      {HypothesisOutcome::refuted, -9.0, 20, 13, 44.0, {{3, 3}}}};
  return fleet;
}

void expect_reason(const LoopAccount& account, const std::string& part) {
  EXPECT_NE(account.reason.find(part), std::string::npos) << account.reason;
  EXPECT_EQ(account.reason.find('\n'), std::string::npos);
}

TEST(LoopAccount, ACandidateThatRegistrationRefusedSaysWhy) {
  LoopOutcome outcome = outcome_of(0, 0, false, 0.0);
  outcome.loop.verdict = LoopVerdict::rejected;
  outcome.loop.reason = "4 inliers";
  const LoopAccount account =
      account_of(outcome, tested(HypothesisOutcome::unsure), pair_with(0, "evidence 5.0 of 9.2"));
  EXPECT_EQ(account.reason, "not registered: 4 inliers");
  EXPECT_FALSE(account.hypothesis);
}

TEST(LoopAccount, ATestedLoopNamesItsHypothesisAndWhatBecameOfIt) {
  const FleetGraph accepted = tested(HypothesisOutcome::accepted);
  const FleetSolution merged = pair_with(1, "");
  const LoopAccount used = account_of(outcome_of(0, 0, true, 1.0), accepted, merged);
  EXPECT_EQ(used.hypothesis, 0U);
  EXPECT_EQ(used.merge_check, "accepted");
  expect_reason(used, "in use: scans agree at 19 of 20 places along hypothesis 1");
  expect_reason(account_of(outcome_of(2, 2, false, 0.0), accepted, merged),
                "hypothesis 3 is far less likely");
  expect_reason(account_of(outcome_of(3, 3, false, 0.0), accepted, merged),
                "scans differ at 7 of 20 places along hypothesis 4");
  expect_reason(account_of(outcome_of(0, 0, true, 0.1), accepted, merged), "switched off by GNC");
  const LoopAccount alone = account_of(outcome_of(9, 9, false, 0.0), accepted, merged);
  EXPECT_FALSE(alone.hypothesis);
  expect_reason(alone, "agrees with too few other loops");
}

TEST(LoopAccount, ARefusedMergeSaysWhatItLacks) {
  const FleetSolution refused = pair_with(0, "two hypotheses");
  const LoopAccount unsure =
      account_of(outcome_of(0, 0, false, 0.0), tested(HypothesisOutcome::unsure), refused);
  EXPECT_EQ(unsure.merge_check, "refused");
  expect_reason(unsure, "hypothesis 1 has evidence 5.0 of 9.2 needed");
  const FleetGraph rivals = tested(HypothesisOutcome::rival);
  expect_reason(account_of(outcome_of(0, 0, false, 0.0), rivals, refused),
                "hypothesis 1 has a rival 21 m away");
  expect_reason(account_of(outcome_of(1, 1, false, 0.0), rivals, refused),
                "hypothesis 2 rivals hypothesis 1 from 21 m away");
}

TEST(LoopAccount, ALoopOfAMergeThatWasTakenBackSaysSo) {
  const FleetGraph accepted = tested(HypothesisOutcome::accepted);
  const FleetSolution taken_back = pair_with(1, "taken back: misses by 34 m");
  expect_reason(account_of(outcome_of(0, 0, false, 0.0), accepted, taken_back),
                "maps not joined: taken back: misses by 34 m");
  expect_reason(account_of(outcome_of(3, 3, false, 0.0), accepted, taken_back), "scans differ at 7 of 20");
}

TEST(LoopAccount, WithoutATestPcmAndTooFewLoopsDecide) {
  const LoopAccount dropped = account_of(outcome_of(0, 0, false, 0.0), {}, pair_with(6, ""));
  EXPECT_EQ(dropped.merge_check, "none");
  expect_reason(dropped, "dropped by PCM");
  expect_reason(account_of(outcome_of(0, 0, true, 1.0), {}, pair_with(6, "")), "in use");
  expect_reason(account_of(outcome_of(0, 0, true, 0.0), {}, pair_with(1, "only 1 of 4 loops agree")),
                "maps not joined: only 1 of 4 loops agree");
  expect_reason(account_of(outcome_of(0, 0, false, 0.0), {}, pair_with(0, "never compared")),
                "maps not joined: never compared");
  expect_reason(account_of(outcome_of(0, 0, false, 0.0), {}, pair_with(0, "")), "not known yet");
}

TEST(LoopAccount, ARivalThatAMessageDoesNotNameIsNotLookedFor) {
  FleetGraph fleet = tested(HypothesisOutcome::rival);
  fleet.checks.at({{0}, {1}}).hypotheses.resize(1);
  fleet.checks.at({{0}, {1}}).hypotheses.shrink_to_fit();
  const LoopAccount account = account_of(outcome_of(0, 0, false, 0.0), fleet, pair_with(0, "rivals"));
  EXPECT_EQ(account.reason, "not in use: hypothesis 1 has a rival");
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/loop_account.hpp"

#include <algorithm>

#include "adit/core/format.hpp"

namespace adit {
namespace {

const MergeCheck* check_of(const FleetGraph& fleet, const LoopClosure& loop) {
  const auto found = fleet.checks.find({loop.from.robot, loop.to.robot});
  return found == fleet.checks.end() ? nullptr : &found->second;
}

const PairOutcome* pair_of(const FleetSolution& solution, const LoopClosure& loop) {
  const auto found = std::ranges::find_if(solution.pairs, [&](const PairOutcome& pair) {
    return pair.a == loop.from.robot && pair.b == loop.to.robot;
  });
  return found == solution.pairs.end() ? nullptr : &*found;
}

std::optional<std::size_t> hypothesis_of(const MergeCheck& check, const LoopClosure& loop) {
  const std::pair ends(loop.from.index, loop.to.index);
  const auto found = std::ranges::find_if(check.hypotheses, [&](const MergeHypothesis& hypothesis) {
    return std::ranges::find(hypothesis.loops, ends) != hypothesis.loops.end();
  });
  if (found == check.hypotheses.end()) return std::nullopt;
  return static_cast<std::size_t>(found - check.hypotheses.begin());
}

/// What the test found of the hypothesis that a loop belongs to.
std::string finding(const MergeCheck& check, std::size_t index) {
  const MergeHypothesis& h = check.hypotheses[index];
  const std::size_t number = index + 1;
  switch (h.outcome) {
    case HypothesisOutcome::accepted:
      return format("scans agree at {} of {} places along hypothesis {}", h.num_passed, h.num_checked,
                    number);
    case HypothesisOutcome::refuted:
      return format("scans differ at {} of {} places along hypothesis {}", h.num_differing(), h.num_checked,
                    number);
    case HypothesisOutcome::unsure:
      return format("hypothesis {} has evidence {:.1f} of {:.1f} needed", number, h.evidence, check.needed);
    case HypothesisOutcome::rival:
      if (index > 0)
        return format("hypothesis {} rivals hypothesis 1 from {:.0f} m away", number, h.from_best_m);
      // A check that a message brought may name no other one.
      return check.hypotheses.size() > 1
                 ? format("hypothesis 1 has a rival {:.0f} m away", check.hypotheses[1].from_best_m)
                 : std::string("hypothesis 1 has a rival");
    case HypothesisOutcome::behind:
      return format("hypothesis {} is far less likely than hypothesis 1", number);
    case HypothesisOutcome::vetoed:
      return format("a person keeps these maps apart, whatever the evidence of hypothesis {}", number);
  }
  return format("hypothesis {}", number);
}

std::string reason_of(const LoopOutcome& outcome, const MergeCheck* check,
                      std::optional<std::size_t> hypothesis, const PairOutcome* pair) {
  if (outcome.loop.verdict != LoopVerdict::accepted) return "not registered: " + outcome.loop.reason;
  if (outcome.in_use())
    return hypothesis ? "in use: " + finding(*check, *hypothesis)
                      : std::string("in use: agrees with the odometries and the other loops in use");
  // Of a merge that passed its test and was taken back, no loop is selected.
  const bool passed = hypothesis && check->hypotheses[*hypothesis].outcome == HypothesisOutcome::accepted;
  if ((outcome.is_selected || passed) && pair != nullptr && !pair->merged)
    return "maps not joined: " + pair->refused_reason;
  if (outcome.is_selected)
    return "switched off by GNC: errs by more than noise from what odometry and the other loops say";
  if (passed && check->accepted) return "not in use: a person left it out";
  if (check != nullptr && !check->hypotheses.empty())
    return hypothesis ? "not in use: " + finding(*check, *hypothesis)
                      : std::string("not in use: agrees with too few other loops to be a hypothesis");
  if (pair != nullptr && pair->num_selected > 0)
    return format("dropped by PCM: disagrees with some of the {} loops of the largest consistent set",
                  pair->num_selected);
  return pair != nullptr && !pair->merged ? "maps not joined: " + pair->refused_reason
                                          : std::string("not in use: one of its keyframes is not known yet");
}

}  // namespace

LoopAccount account_of(const LoopOutcome& outcome, const FleetGraph& fleet, const FleetSolution& solution) {
  const MergeCheck* check = check_of(fleet, outcome.loop);
  LoopAccount account;
  if (check != nullptr && outcome.loop.verdict == LoopVerdict::accepted)
    account.hypothesis = hypothesis_of(*check, outcome.loop);
  const PairOutcome* pair = pair_of(solution, outcome.loop);
  account.merge_check = check == nullptr ? "none" : check->accepted ? "accepted" : "refused";
  account.reason = reason_of(outcome, check, account.hypothesis, pair);
  return account;
}

}  // namespace adit

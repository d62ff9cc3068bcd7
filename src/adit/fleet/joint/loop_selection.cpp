// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/loop_selection.hpp"

#include <iterator>
#include <set>

#include "adit/core/format.hpp"
#include "adit/fleet/joint/merge_cycles.hpp"

namespace adit {
namespace {

/// The odometry of those robots that have loops, each made once.
class ChainsOnDemand {
 public:
  explicit ChainsOnDemand(const FleetGraph& fleet) : fleet_(fleet) {}
  const OdometryChain& of(RobotId robot) {
    const auto known = chains_.find(robot);
    return known != chains_.end() ? known->second
                                  : chains_.emplace(robot, chain_of(fleet_.robots.at(robot))).first->second;
  }

 private:
  const FleetGraph& fleet_;
  Chains chains_;
};

std::vector<PairOutcome> all_pairs(const FleetGraph& fleet) {
  std::vector<PairOutcome> pairs;
  for (auto a = fleet.robots.begin(); a != fleet.robots.end(); ++a) {
    for (auto b = std::next(a); b != fleet.robots.end(); ++b) {
      PairOutcome& pair = pairs.emplace_back();
      pair.a = a->first;
      pair.b = b->first;
    }
  }
  return pairs;
}

/// All loops that may be chosen, none of them chosen yet.
LoopSelection nothing_selected(const FleetGraph& fleet) {
  LoopSelection selection;
  for (const auto& [ends, loop] : fleet.loops) {
    if (loop.verdict != LoopVerdict::accepted || !fleet.knows(loop.from) || !fleet.knows(loop.to)) continue;
    selection.loops.push_back({loop, false, 0.0});
  }
  selection.pairs = all_pairs(fleet);
  for (const PairOutcome& pair : selection.pairs) selection.of_pairs[{pair.a, pair.b}] = {};
  for (std::size_t l = 0; l < selection.loops.size(); ++l) {
    const LoopClosure& loop = selection.loops[l].loop;
    selection.of_pairs[{loop.from.robot, loop.to.robot}].push_back(l);
  }
  return selection;
}

/// Runs PCM on the loops of one pair (indices into `loops`), marks the ones it keeps and fills in the clique
/// sizes.
void keep_consistent(ChainsOnDemand& chains, const BackEndConfig& config,
                     const std::vector<std::size_t>& of_pair, std::vector<LoopOutcome>& loops,
                     PairOutcome& pair) {
  std::vector<PcmLoop> measured;
  for (const std::size_t l : of_pair) measured.push_back(pcm_loop_of(loops[l].loop));
  const PcmResult result = pcm(chains.of(pair.a), chains.of(pair.b), measured, config.pcm);
  for (const std::size_t kept : result.largest) loops[of_pair[kept]].is_selected = true;
  pair.num_selected = result.largest.size();
  pair.second_clique = result.second.size();
  pair.clique_exact = result.optimal;
}

/// Keeps the loops between two robots, or within one, that an accepted check speaks of; their number.
std::size_t keep_checked(const FleetGraph& fleet, const RobotPair& robots,
                         const std::vector<std::size_t>& of_pair, std::vector<LoopOutcome>& loops) {
  const auto check = fleet.checks.find(robots);
  if (check == fleet.checks.end() || !check->second.accepted) return 0;
  std::size_t num = 0;
  const std::set<std::pair<std::uint32_t, std::uint32_t>> checked(check->second.loops.begin(),
                                                                  check->second.loops.end());
  for (const std::size_t l : of_pair) {
    const LoopClosure& loop = loops[l].loop;
    loops[l].is_selected = checked.contains({loop.from.index, loop.to.index});
    num += loops[l].is_selected ? 1 : 0;
  }
  return num;
}

/// Loops within one robot's map are used only where they passed their test, whatever the other pairs need.
void keep_revisits(const FleetGraph& fleet, LoopSelection& selection) {
  for (const auto& [robots, of_pair] : selection.of_pairs)
    if (robots.first == robots.second) keep_checked(fleet, robots, of_pair, selection.loops);
}

std::string taken_back(const FleetGraph& fleet, const std::vector<Merge>& merges,
                       const Contradiction& contradiction) {
  if (!contradiction.refuted.empty()) {
    std::string pairs;
    for (const auto& [a, b] : contradiction.refuted)
      pairs +=
          format("{}{}-{}", pairs.empty() ? "" : " and ", fleet.robots.at(a).name, fleet.robots.at(b).name);
    return format(
        "taken back: with other merges it would put {} where their own scans differ; a meeting with further "
        "robots would decide",
        pairs);
  }
  std::string others;
  bool has_least_evidence = true;
  for (const std::size_t m : contradiction.others) {
    others += format("{}{}-{}", others.empty() ? "" : " and ", fleet.robots.at(merges[m].a).name,
                     fleet.robots.at(merges[m].b).name);
    if (merges[m].evidence < merges[contradiction.merge].evidence) has_least_evidence = false;
  }
  return format(
      "taken back: with {} it misses by {:.0f} m around a cycle with {:.0f} m of odometry, and {}; a meeting "
      "with further robots would decide",
      others, contradiction.miss_m, contradiction.driven_m,
      has_least_evidence ? "has the least evidence of them" : "without it the others agree best");
}

/// The hypothesis with those of its loops that are known and were accepted, as are their keyframes. What
/// others say of a rejected one has no information that could be inverted.
Merge merge_of(const FleetGraph& fleet, const MergeCheck& check, const MergeHypothesis& hypothesis) {
  Merge merge{check.a, check.b, hypothesis.evidence, {}};
  for (const auto& [a, b] : hypothesis.loops) {
    const auto loop = fleet.loops.find({{check.a, a}, {check.b, b}});
    if (loop != fleet.loops.end() && loop->second.verdict == LoopVerdict::accepted &&
        fleet.knows({check.a, a}) && fleet.knows({check.b, b}))
      merge.loops.push_back(pcm_loop_of(loop->second));
  }
  return merge;
}

/// What scans refuted about pairs of robots that did not merge.
std::vector<Merge> refuted_hypotheses(const FleetGraph& fleet) {
  std::vector<Merge> out;
  for (const auto& [pair, check] : fleet.checks) {
    if (check.accepted || check.a == check.b) continue;
    for (const MergeHypothesis& hypothesis : check.hypotheses) {
      if (hypothesis.outcome != HypothesisOutcome::refuted) continue;
      Merge merge = merge_of(fleet, check, hypothesis);
      if (!merge.loops.empty()) out.push_back(std::move(merge));
    }
  }
  return out;
}

/// The merges of all pairs, judged by one another.
class MergeReview {
 public:
  MergeReview(const FleetGraph& fleet, ChainsOnDemand& chains, const BackEndConfig& config,
              LoopSelection& selection)
      : fleet_(fleet), config_(config), selection_(selection) {
    for (const PairOutcome& pair : selection.pairs) {
      for (const RobotId robot : {pair.a, pair.b})
        if (fleet.checks.contains({pair.a, pair.b})) chains_.emplace(robot, chains.of(robot));
      if (pair.num_selected == 0) continue;
      Merge merge{pair.a, pair.b, fleet.checks.at({pair.a, pair.b}).evidence, {}};
      for (const std::size_t l : selection.of_pairs.at({pair.a, pair.b}))
        if (selection.loops[l].is_selected) merge.loops.push_back(pcm_loop_of(selection.loops[l].loop));
      merges_.push_back(std::move(merge));
    }
  }

  /// Takes the loops of merges out that cycles of robots contradict.
  void take_back() {
    for (const Contradiction& contradiction :
         contradictions(merges_, refuted_hypotheses(fleet_), chains_, config_.cycles)) {
      const Merge& merge = merges_[contradiction.merge];
      outcome_of(merge).refused_kind = RefusalKind::taken_back;
      outcome_of(merge).refused_reason = taken_back(fleet_, merges_, contradiction);
      for (const std::size_t l : selection_.of_pairs.at({merge.a, merge.b}))
        selection_.loops[l].is_selected = false;
    }
  }

 private:
  PairOutcome& outcome_of(const Merge& merge) {
    return *std::ranges::find_if(
        selection_.pairs, [&](const PairOutcome& pair) { return pair.a == merge.a && pair.b == merge.b; });
  }

  const FleetGraph& fleet_;
  const BackEndConfig& config_;
  LoopSelection& selection_;
  Chains chains_;
  std::vector<Merge> merges_;
};

}  // namespace

LoopSelection select_loops(const FleetGraph& fleet, const BackEndConfig& config) {
  const bool is_adaptive = fleet.policy == MergePolicy::adaptive;
  LoopSelection selection = nothing_selected(fleet);
  ChainsOnDemand chains(fleet);
  for (PairOutcome& pair : selection.pairs) {
    const std::vector<std::size_t>& of_pair = selection.of_pairs.at({pair.a, pair.b});
    pair.num_loops = of_pair.size();
    if (is_adaptive) {
      pair.num_selected = keep_checked(fleet, {pair.a, pair.b}, of_pair, selection.loops);
    } else if (!config.pcm_on || of_pair.empty()) {
      for (const std::size_t l : of_pair) selection.loops[l].is_selected = true;
    } else {
      keep_consistent(chains, config, of_pair, selection.loops, pair);
    }
  }
  keep_revisits(fleet, selection);
  if (is_adaptive && config.cycles_needed) MergeReview(fleet, chains, config, selection).take_back();
  return selection;
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/sync/fleet_ledger.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "adit/core/check.hpp"
#include "adit/fleet/sync/parts.hpp"

namespace adit {
namespace {

/// The solver inverts the covariance of each step; the first keyframe has none.
bool has_usable_covariances(const GraphPart& part) {
  for (std::size_t i = part.first_index == 0 ? 1 : 0; i < part.nodes.size(); ++i)
    if (!is_usable(part.nodes[i].step_covariance)) return false;
  return true;
}

/// What the wire does not bound.
///@{
bool is_bounded(const LoopClosure& loop) { return loop.reason.size() <= kBytesPerText; }
bool is_bounded(const MergeCheck& check) {
  std::size_t num_items = check.loops.size();
  for (const MergeHypothesis& hypothesis : check.hypotheses)
    num_items += hypothesis.loops.size() + hypothesis.places.size();
  return num_items <= kItemsPerCheck && check.reason.size() <= kBytesPerText;
}
///@}

std::size_t size_of(const auto& by_author, RobotId author) {
  const auto known = by_author.find(author);
  return known == by_author.end() ? 0 : known->second.size();
}

const Hello::Known* entry_of(const Hello& hello, RobotId robot) {
  const auto found = std::ranges::find(hello.known, robot, &Hello::Known::robot);
  return found == hello.known.end() ? nullptr : &*found;
}

}  // namespace

FleetLedger::FleetLedger(RobotId self, RobotGraph own, MergePolicy policy) : self_(self) {
  known_.policy = policy;
  known_.robots[self] = std::move(own);
}

std::size_t FleetLedger::num_nodes_of(RobotId robot) const {
  const auto graph = known_.robots.find(robot);
  return graph == known_.robots.end() ? 0 : graph->second.nodes.size();
}

std::size_t FleetLedger::num_own_loops() const { return size_of(loops_by_, self_); }
std::size_t FleetLedger::num_own_checks() const { return size_of(checks_by_, self_); }

void FleetLedger::add_own(const LoopClosure& loop) { keep(self_, loop); }
void FleetLedger::add_own(MergeCheck check) { keep(self_, std::move(check)); }

void FleetLedger::keep(RobotId author, LoopClosure loop) {
  if (loop.verdict == LoopVerdict::accepted && !is_usable(loop.information)) {
    loop.verdict = LoopVerdict::rejected;
    loop.reason = "its information is not positive definite or has no finite inverse";
  }
  const KeyframePair ends{loop.from, loop.to};
  // Nobody registers a loop twice: repeated, it would grow the list for ever.
  if (known_.loops.try_emplace(ends, std::move(loop)).second) loops_by_[author].push_back(ends);
}

void FleetLedger::keep(RobotId author, MergeCheck check) {
  known_.checks[{check.a, check.b}] = check;
  checks_by_[author].push_back(std::move(check));
}

bool FleetLedger::take(const GraphPart& part) {
  if (part.owner == self_ || part.name.size() > kBytesPerText || !has_usable_covariances(part)) return false;
  const std::size_t has = num_nodes_of(part.owner);
  if (part.first_index > has || part.first_index + part.nodes.size() > kKeyframesPerRobot) return false;
  RobotGraph& graph = known_.robots[part.owner];
  graph.name = part.name;
  for (std::size_t i = has - part.first_index; i < part.nodes.size(); ++i)
    graph.nodes.push_back(part.nodes[i]);
  return true;
}

bool FleetLedger::take(const Loops& part) { return part.author != self_ && add(part); }
bool FleetLedger::take(const MergeChecks& part) { return part.author != self_ && add(part); }

bool FleetLedger::restore(const MessageBody& finding) {
  if (const auto* loops = std::get_if<Loops>(&finding)) return add(*loops);
  const auto* checks = std::get_if<MergeChecks>(&finding);
  return checks != nullptr && add(*checks);
}

void FleetLedger::overrule(MergeCheck check) {
  ADIT_CHECK(check.a <= check.b, "a check names the smaller robot first");
  const RobotId author = check.a;
  keep(author, std::move(check));
}

void FleetLedger::note_unsearched(RobotId peer, std::string why) {
  if (why.empty())
    known_.unsearched.erase({self_, peer});
  else
    known_.unsearched[{self_, peer}] = std::move(why);
}

bool FleetLedger::add(const Loops& part) {
  const auto is_authors = [&](const LoopClosure& loop) {
    return loop.from.robot == part.author && loop.from.robot <= loop.to.robot && loop.from < loop.to &&
           is_bounded(loop);
  };
  const std::size_t has = size_of(loops_by_, part.author);
  if (part.first > has || part.first + part.loops.size() > kLoopsPerRobot ||
      !std::ranges::all_of(part.loops, is_authors))
    return false;
  for (std::size_t l = has - part.first; l < part.loops.size(); ++l) keep(part.author, part.loops[l]);
  return true;
}

bool FleetLedger::add(const MergeChecks& part) {
  const auto is_authors = [&](const MergeCheck& check) {
    return check.a == part.author && check.a <= check.b && is_bounded(check);
  };
  const std::size_t has = size_of(checks_by_, part.author);
  if (part.first > has || part.first + part.checks.size() > kChecksPerRobot ||
      !std::ranges::all_of(part.checks, is_authors))
    return false;
  for (std::size_t c = has - part.first; c < part.checks.size(); ++c) keep(part.author, part.checks[c]);
  return true;
}

std::map<RobotId, Hello::Known> FleetLedger::summary() const {
  std::map<RobotId, Hello::Known> summary;
  for (const auto& [robot, graph] : known_.robots)
    summary[robot].num_nodes = static_cast<std::uint32_t>(graph.nodes.size());
  for (const auto& [robot, loops] : loops_by_)
    summary[robot].num_loops = static_cast<std::uint32_t>(loops.size());
  for (const auto& [robot, checks] : checks_by_)
    summary[robot].num_checks = static_cast<std::uint32_t>(checks.size());
  for (auto& [robot, entry] : summary) entry.robot = robot;
  return summary;
}

std::vector<MessageBody> FleetLedger::news_for(RobotId peer, const Hello& theirs) const {
  std::vector<MessageBody> news;
  for (const auto& entry : known_.robots) {
    const RobotId robot = entry.first;
    const RobotGraph& graph = entry.second;
    const Hello::Known* known = entry_of(theirs, robot);
    // Of a robot without keyframes there is nothing to send but that it exists.
    if (known == nullptr && graph.nodes.empty()) news.emplace_back(GraphPart{robot, graph.name, 0, {}});
    for_parts(graph.nodes, known == nullptr ? 0 : known->num_nodes, kNodesPerMessage,
              [&](std::uint32_t first, std::vector<GraphNode> nodes) {
                news.emplace_back(GraphPart{robot, graph.name, first, std::move(nodes)});
              });
  }
  for (const auto& [author, loops] : loops_by_) {
    if (author == peer) continue;
    const Hello::Known* known = entry_of(theirs, author);
    append(news, loops_since(author, known == nullptr ? 0 : known->num_loops));
  }
  for (const auto& [author, checks] : checks_by_) {
    if (author == peer) continue;
    const Hello::Known* known = entry_of(theirs, author);
    append(news, checks_since(author, known == nullptr ? 0 : known->num_checks));
  }
  return news;
}

std::vector<MessageBody> FleetLedger::loops_since(RobotId author, std::size_t first) const {
  std::vector<MessageBody> out;
  const auto all = loops_by_.find(author);
  if (all == loops_by_.end()) return out;
  for_parts(all->second, first, kLoopsPerMessage,
            [&](std::uint32_t begin, const std::vector<KeyframePair>& part) {
              Loops loops{author, begin, {}};
              for (const KeyframePair& ends : part) loops.loops.push_back(known_.loops.at(ends));
              out.emplace_back(std::move(loops));
            });
  return out;
}

std::vector<MessageBody> FleetLedger::checks_since(RobotId author, std::size_t first) const {
  std::vector<MessageBody> out;
  const auto all = checks_by_.find(author);
  if (all == checks_by_.end()) return out;
  for_parts(all->second, first, kChecksPerMessage, [&](std::uint32_t begin, std::vector<MergeCheck> part) {
    out.emplace_back(MergeChecks{author, begin, std::move(part)});
  });
  return out;
}

std::vector<MessageBody> FleetLedger::findings() const {
  std::vector<MessageBody> out;
  for (const auto& [author, loops] : loops_by_) append(out, loops_since(author, 0));
  for (const auto& [author, checks] : checks_by_) append(out, checks_since(author, 0));
  return out;
}

}  // namespace adit

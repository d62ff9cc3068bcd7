// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/fleet_estimate.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "adit/core/decompositions.hpp"
#include "adit/core/disjoint_sets.hpp"
#include "adit/core/format.hpp"
#include "adit/fleet/joint/frames.hpp"
#include "adit/fleet/joint/loop_selection.hpp"

namespace adit {
namespace {

/// Rounds in which loops that came at once are judged and the map settles.
constexpr int kRounds = 20;
/// All information is divided by this, which moves no pose: merges are decided, so that a loop is left out
/// only where it errs by more than twice what is stated. Stated variances are right within a factor of two or
/// so (decisions 0033 and 0034); the solver finds out where they are better.
constexpr double kBenefitOfDoubt = 4.0;

using Loops = std::vector<const LoopClosure*>;

KeyframePair ends_of(const LoopClosure& loop) { return {loop.from, loop.to}; }

/// Of each pair of robots that has to be joined, pairs with most loops first, the loop that fits the frame of
/// all of them best.
Loops joining_loops(const FleetGraph& known, const std::vector<RobotId>& robots, const Loops& loops,
                    const Frames& frames) {
  std::map<RobotPair, Loops> by_pair;
  for (const LoopClosure* loop : loops)
    if (loop->from.robot != loop->to.robot) by_pair[{loop->from.robot, loop->to.robot}].push_back(loop);
  std::vector<const Loops*> widest_first;
  for (const auto& [pair, of_pair] : by_pair) widest_first.push_back(&of_pair);
  std::ranges::stable_sort(widest_first, std::ranges::greater(), [](const Loops* l) { return l->size(); });
  const auto placed = [&](KeyframeId id) {
    return frames.at(id.robot) * known.robots.at(id.robot).nodes[id.index].T_odom_base;
  };
  const auto misfit = [&](const LoopClosure* loop) {
    const Pose T_from_to = placed(loop->from).inverse() * placed(loop->to);
    const Vector6 error = (loop->T_from_to.inverse() * T_from_to).log();
    return error.dot(loop->information * error);
  };
  const auto position = [&](RobotId robot) {
    return static_cast<std::size_t>(std::ranges::lower_bound(robots, robot) - robots.begin());
  };
  DisjointSets sets(robots.size());
  Loops joining;
  for (const Loops* of_pair : widest_first) {
    const std::size_t a = position(of_pair->front()->from.robot);
    const std::size_t b = position(of_pair->front()->to.robot);
    if (sets.find(a) == sets.find(b)) continue;
    sets.join(a, b);
    joining.push_back(*std::ranges::min_element(*of_pair, {}, misfit));
  }
  return joining;
}

}  // namespace

void FleetEstimate::add_keyframes(Map& map, RobotId robot, const RobotGraph& own, const Pose& T_map_odom) {
  std::vector<std::size_t>& nodes = map.nodes[robot];
  for (auto k = static_cast<std::uint32_t>(nodes.size()); k < own.nodes.size(); ++k) {
    const Pose& T_odom_base = own.nodes[k].T_odom_base;
    const std::uint64_t key = graph_key({robot, k});
    if (k == 0) {
      nodes.push_back(map.graph.add_node(key, T_map_odom * T_odom_base));
      continue;
    }
    const Pose T_before_here = own.nodes[k - 1].T_odom_base.inverse() * T_odom_base;
    const Pose T_map_before = map.graph.poses()[nodes.back()];
    nodes.push_back(map.graph.add_node(key, T_map_before * T_before_here));
    map.graph.add_edge({nodes[k - 1], nodes[k], T_before_here,
                        inverse(own.nodes[k].step_covariance) / kBenefitOfDoubt, EdgeKind::odometry});
  }
}

void FleetEstimate::add_loop(Map& map, const LoopClosure& loop, EdgeKind kind) {
  map.loops[ends_of(loop)] = map.graph.add_edge({map.nodes.at(loop.from.robot)[loop.from.index],
                                                 map.nodes.at(loop.to.robot)[loop.to.index], loop.T_from_to,
                                                 loop.information / kBenefitOfDoubt, kind});
}

/// No loop that the map has taken in was withdrawn.
bool FleetEstimate::can_grow(const Map& map, const Loops& loops) {
  std::set<KeyframePair> selected;
  for (const LoopClosure* loop : loops) selected.insert(ends_of(*loop));
  return std::ranges::all_of(map.loops, [&](const auto& entry) { return selected.contains(entry.first); });
}

FleetEstimate::Map FleetEstimate::begin(const FleetGraph& known, const std::vector<RobotId>& robots,
                                        const Loops& loops) {
  Loops between;
  for (const LoopClosure* loop : loops)
    if (loop->from.robot != loop->to.robot) between.push_back(loop);
  const Frames frames = common_frames(known, between);
  Map map;
  for (const RobotId robot : robots) add_keyframes(map, robot, known.robots.at(robot), frames.at(robot));
  for (const LoopClosure* loop : joining_loops(known, robots, loops, frames))
    add_loop(map, *loop, EdgeKind::odometry);
  return map;
}

void FleetEstimate::solve(Map& map, Step& step) {
  const auto solved = map.graph.update();
  step.iterations += solved.iterations;
  if (solved.status != SolveStatus::converged && solved.status != SolveStatus::max_iterations)
    step.problems.push_back(solved.reason);
}

FleetEstimate::Step FleetEstimate::update(const FleetGraph& known, const BackEndConfig& config) {
  Step step;
  const LoopSelection selection = select_loops(known, config);
  Loops selected;
  for (const LoopOutcome& outcome : selection.loops)
    if (outcome.is_selected) selected.push_back(&outcome.loop);
  std::map<std::vector<RobotId>, Map> maps;
  // Where this throws, the next update begins all maps anew: no map is left of which a part was moved.
  std::map<std::vector<RobotId>, Map> maps_before = std::exchange(maps_, {});
  for (const std::vector<RobotId>& robots : linked_robots(known, selected)) {
    if (known.robots.at(robots.front()).nodes.empty()) continue;  // no loop links it
    Loops loops;
    for (const LoopClosure* loop : selected)
      if (std::ranges::binary_search(robots, loop->from.robot)) loops.push_back(loop);
    const auto before = maps_before.find(robots);
    const bool is_new = before == maps_before.end() || !can_grow(before->second, loops);
    if (is_new) ++step.num_begun_anew;
    Map& map =
        maps.emplace(robots, is_new ? begin(known, robots, loops) : std::move(before->second)).first->second;
    for (const RobotId robot : robots) {
      const RobotGraph& own = known.robots.at(robot);
      step.num_keyframes += own.nodes.size() - (poses_.contains(robot) ? poses_.at(robot).size() : 0);
      add_keyframes(map, robot, own, Pose());
    }
    for (const LoopClosure* loop : loops)
      if (!map.loops.contains(ends_of(*loop))) add_loop(map, *loop, EdgeKind::loop);
    for (int round = 0; round < kRounds; ++round) {
      const int before_round = step.iterations;
      solve(map, step);
      if (step.iterations == before_round) break;
    }
    for (const auto& [robot, nodes] : map.nodes) {
      std::vector<Pose>& poses = poses_[robot];
      poses.resize(nodes.size());
      for (std::size_t k = 0; k < nodes.size(); ++k) poses[k] = map.graph.poses()[nodes[k]];
    }
  }
  maps_ = std::move(maps);
  return step;
}

std::vector<std::vector<RobotId>> FleetEstimate::maps() const {
  std::vector<std::vector<RobotId>> out;
  for (const auto& [robots, map] : maps_) out.push_back(robots);
  return out;
}

bool FleetEstimate::is_in_use(const KeyframePair& ends) const {
  return std::ranges::any_of(maps_, [&](const auto& entry) {
    const auto edge = entry.second.loops.find(ends);
    return edge != entry.second.loops.end() && entry.second.graph.is_in_use(edge->second);
  });
}

EstimateDifference difference(const FleetEstimate& estimate, const FleetSolution& solution) {
  EstimateDifference out;
  for (const auto& [robot, poses] : estimate.T_map_keyframe()) {
    const std::vector<Pose>& solved = solution.T_world_keyframe.at(robot);
    for (std::size_t k = 0; k < poses.size(); ++k)
      out.largest_m = std::max(out.largest_m, (poses[k].translation() - solved[k].translation()).norm());
  }
  for (const LoopOutcome& outcome : solution.loops)
    if (outcome.is_selected && outcome.in_use() != estimate.is_in_use(ends_of(outcome.loop)))
      ++out.num_judged_otherwise;
  return out;
}

}  // namespace adit

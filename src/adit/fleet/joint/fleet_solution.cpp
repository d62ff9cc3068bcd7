// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/fleet_solution.hpp"

#include <algorithm>

#include "adit/core/decompositions.hpp"
#include "adit/core/format.hpp"
#include "adit/fleet/joint/condensed_graph.hpp"
#include "adit/fleet/joint/frames.hpp"
#include "adit/fleet/joint/loop_selection.hpp"
#include "adit/fleet/merge/merge_advice.hpp"

namespace adit {

namespace {

PoseGraph build_graph(const FleetGraph& fleet, const std::vector<const LoopOutcome*>& outcomes) {
  std::vector<const LoopClosure*> loops;
  for (const LoopOutcome* outcome : outcomes) loops.push_back(&outcome->loop);
  const Frames frames = common_frames(fleet, loops);
  PoseGraph graph;
  std::map<RobotId, std::size_t> offset;
  for (const auto& [robot, own] : fleet.robots) {
    offset[robot] = graph.nodes.size();
    for (std::uint32_t k = 0; k < own.nodes.size(); ++k) {
      graph.nodes.push_back({graph_key({robot, k}), frames.at(robot) * own.nodes[k].T_odom_base});
      if (k == 0) continue;
      const std::size_t node = graph.nodes.size() - 1;
      graph.edges.push_back({node - 1, node,
                             own.nodes[k - 1].T_odom_base.inverse() * own.nodes[k].T_odom_base,
                             inverse(own.nodes[k].step_covariance), EdgeKind::odometry});
    }
  }
  for (const LoopOutcome* outcome : outcomes) {
    const LoopClosure& loop = outcome->loop;
    graph.edges.push_back({offset.at(loop.from.robot) + loop.from.index,
                           offset.at(loop.to.robot) + loop.to.index, loop.T_from_to, loop.information,
                           EdgeKind::loop});
  }
  return graph;
}

/// Groups of robots, by the loops in use.
std::vector<std::vector<RobotId>> linked_robots(const FleetGraph& fleet,
                                                const std::vector<LoopOutcome>& outcomes) {
  std::vector<const LoopClosure*> in_use;
  for (const LoopOutcome& outcome : outcomes)
    if (outcome.in_use()) in_use.push_back(&outcome.loop);
  return linked_robots(fleet, in_use);
}

/// The part of the fleet that these robots are.
FleetGraph part_of(const FleetGraph& fleet, const std::vector<RobotId>& robots) {
  FleetGraph part;
  for (const RobotId robot : robots) part.robots[robot] = fleet.robots.at(robot);
  return part;
}

/// What was tried between two robots.
struct Tried {
  std::size_t num_registered = 0;
  std::size_t num_rejected = 0;
  std::map<std::string, int> reasons;  ///< Of those rejected.
};

std::map<RobotPair, Tried> tried_by_pair(const FleetGraph& fleet) {
  std::map<RobotPair, Tried> by_pair;
  for (const auto& [ends, loop] : fleet.loops) {
    Tried& tried = by_pair[{ends.first.robot, ends.second.robot}];
    if (loop.verdict == LoopVerdict::accepted) {
      ++tried.num_registered;
      continue;
    }
    ++tried.num_rejected;
    ++tried.reasons[loop.reason];
  }
  return by_pair;
}

struct Refusal {
  RefusalKind kind;
  std::string reason;
};

/// By the merge check, or where it names no place, `anywhere`.
std::string where_to_drive_for(const FleetGraph& fleet, const PairOutcome& pair, std::string anywhere) {
  const auto check = fleet.checks.find({pair.a, pair.b});
  if (check == fleet.checks.end() || !check->second.advice) return anywhere;
  return in_words(*check->second.advice, fleet.robots.at(pair.a).name, fleet.robots.at(pair.b).name);
}

/// Where no loop can take part.
Refusal without_loops(const FleetGraph& fleet, const PairOutcome& pair, const Tried& tried) {
  for (const RobotId robot : {pair.a, pair.b}) {
    if (fleet.robots.at(robot).nodes.empty()) {
      return {RefusalKind::no_loop,
              format("the keyframe policy left no keyframe of {}; keep more of them, or drive on",
                     fleet.robots.at(robot).name)};
    }
  }
  if (tried.num_registered > 0) {
    return {
        RefusalKind::no_loop,
        format("{} loops, but the odometry on which they lie has not all come; the robots have to meet again",
               tried.num_registered)};
  }
  const auto unsearched = fleet.unsearched.find({pair.a, pair.b});
  if (tried.num_rejected == 0 && unsearched != fleet.unsearched.end())
    return {RefusalKind::no_loop, unsearched->second};
  if (tried.num_rejected == 0) {
    return {RefusalKind::no_loop,
            format("no keyframe of {} resembled one of {}; drive on until both have passed the same place, "
                   "none is known yet",
                   fleet.robots.at(pair.a).name, fleet.robots.at(pair.b).name)};
  }
  const auto most = std::ranges::max_element(tried.reasons, {}, &decltype(tried.reasons)::value_type::second);
  return {
      RefusalKind::no_loop,
      format("none of {} candidates could be registered (mostly: {}); {}", tried.num_rejected, most->first,
             where_to_drive_for(fleet, pair,
                                "drive on until both have passed the same place, nearer to one another, "
                                "none is known yet"))};
}

/// Why the solver found no poses for the map that these loops would make; empty where it did, or where none
/// was selected.
std::string failure_of(const FleetSolution& solution, const std::vector<std::size_t>& of_pair) {
  const auto selected =
      std::ranges::find_if(of_pair, [&](std::size_t l) { return solution.loops[l].is_selected; });
  if (selected == of_pair.end()) return {};
  const RobotId robot = solution.loops[*selected].loop.from.robot;
  const auto component = std::ranges::find_if(solution.components, [&](const Component& one) {
    return std::ranges::find(one.robots, robot) != one.robots.end();
  });
  return component->reason;
}

Refusal refusal(const FleetGraph& fleet, const BackEndConfig& config, const PairOutcome& pair,
                const std::string& failure, std::size_t num_used) {
  const auto check = fleet.checks.find({pair.a, pair.b});
  if (check != fleet.checks.end() && !check->second.accepted)
    return {check->second.refused_kind, check->second.reason};
  if (check == fleet.checks.end() && fleet.policy == MergePolicy::adaptive)
    return {RefusalKind::too_little,
            format("{} loops, but scans along them were never compared; the robots have to meet again",
                   pair.num_loops)};
  if (!failure.empty())
    return {RefusalKind::unknown,
            format("{} loops, but the map that they make could not be solved: {}", pair.num_loops, failure)};
  return {RefusalKind::too_little,
          format("only {} of {} loops agree with the odometries of both robots, {} needed; drive a longer "
                 "stretch that both know",
                 num_used, pair.num_loops, config.min_loops)};
}

void decide_merges(const FleetGraph& fleet, const BackEndConfig& config, const LoopsOfPairs& of_pairs,
                   FleetSolution& solution) {
  std::map<RobotPair, Tried> tried = tried_by_pair(fleet);
  for (PairOutcome& pair : solution.pairs) {
    const std::vector<std::size_t>& of_pair = of_pairs.at({pair.a, pair.b});
    const auto num_used = static_cast<std::size_t>(
        std::ranges::count_if(of_pair, [&](std::size_t l) { return solution.loops[l].in_use(); }));
    pair.merged = num_used >= static_cast<std::size_t>(config.min_loops);
    if (pair.merged) continue;
    if (pair.refused_reason.empty()) {
      Refusal found = pair.num_loops == 0
                          ? without_loops(fleet, pair, tried[{pair.a, pair.b}])
                          : refusal(fleet, config, pair, failure_of(solution, of_pair), num_used);
      pair.refused_kind = found.kind;
      pair.refused_reason = std::move(found.reason);
    }
    // Too few loops join no maps, by way of third robots either.
    for (const std::size_t l : of_pair) solution.loops[l].weight = 0.0;
  }
}

MeasurementSource source_of(const PoseGraph& graph, const PoseGraph::Edge& edge) {
  const RobotId from = keyframe_id(graph.nodes[edge.from].key).robot;
  const RobotId to = keyframe_id(graph.nodes[edge.to].key).robot;
  return {edge.kind, {std::min(from, to), std::max(from, to)}};
}

/// Loops of two robots share the errors of two LiDARs, and those that were selected fit one another: none
/// counts as better than it states (decision 0086).
constexpr double kLeastVariance = 1.0;

/// What each source is worth, estimated with the poses, from the poses and weights of `solved`.
Solution<Pose> balanced(PoseGraph graph, const Solution<Pose>& solved, const OptimizerConfig& config,
                        std::map<MeasurementSource, VarianceComponent>& variances) {
  std::map<MeasurementSource, std::size_t> numbers;
  std::vector<std::size_t> sources;
  for (const PoseGraph::Edge& edge : graph.edges)
    sources.push_back(numbers.try_emplace(source_of(graph, edge), numbers.size()).first->second);
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) graph.nodes[i].pose = solved.poses[i];
  BalancedSolution<Pose> found =
      optimize_balanced(graph, sources, numbers.size(), config, solved.edge_weights, kLeastVariance);
  if (!found.solution.ok()) return solved;
  for (const auto& [source, number] : numbers) variances[source] = found.components[number];
  found.solution.edge_weights = solved.edge_weights;
  found.solution.iterations += solved.iterations;
  return std::move(found.solution);
}

/// Poses of one group of robots that share a frame, with the loops between them that are in use.
void solve_group(const FleetGraph& fleet, const std::vector<RobotId>& robots, const BackEndConfig& config,
                 FleetSolution& solution) {
  std::vector<LoopOutcome*> loops;
  for (LoopOutcome& outcome : solution.loops) {
    if (outcome.is_selected && std::ranges::find(robots, outcome.loop.from.robot) != robots.end() &&
        std::ranges::find(robots, outcome.loop.to.robot) != robots.end()) {
      loops.push_back(&outcome);
    }
  }
  const PoseGraph graph =
      build_graph(part_of(fleet, robots), std::vector<const LoopOutcome*>(loops.begin(), loops.end()));
  const LoopsAre confirmed =
      fleet.policy == MergePolicy::adaptive ? LoopsAre::confirmed : LoopsAre::unconfirmed;
  Solution<Pose> solved =
      config.gnc_on ? solve_robustly(graph, config.gnc, confirmed) : optimize(graph, config.gnc.optimizer);
  // The paper's policies state fixed sigmas, and are compared as they are.
  if (config.balance_on && fleet.policy == MergePolicy::adaptive && solved.ok() && !loops.empty())
    solved = balanced(graph, solved, config.gnc.optimizer, solution.variances);
  const std::size_t first_loop = graph.edges.size() - loops.size();
  for (std::size_t l = 0; l < loops.size(); ++l) {
    loops[l]->weight = solved.ok() ? solved.edge_weights[first_loop + l] : 0.0;
  }
  std::size_t node = 0;
  for (const RobotId robot : robots) {
    std::vector<Pose>& poses = solution.T_world_keyframe[robot];
    poses.clear();
    for (std::size_t k = 0; k < fleet.robots.at(robot).nodes.size(); ++k)
      poses.push_back(solved.poses[node++]);
  }
  solution.components.push_back({robots.front(), robots, solved.status, solved.ok() ? "" : solved.reason,
                                 solved.iterations, solved.cost_final});
}

/// Brings the robots of a component into the frame of its anchor's odometry.
void anchor_component(const FleetGraph& fleet, const Component& component, FleetSolution& solution) {
  const auto& nodes = fleet.robots.at(component.anchor).nodes;
  const std::vector<Pose>& anchor_poses = solution.T_world_keyframe.at(component.anchor);
  if (nodes.empty()) return;
  const Pose T_new_old = nodes.front().T_odom_base * anchor_poses.front().inverse();
  for (const RobotId robot : component.robots) {
    for (Pose& pose : solution.T_world_keyframe.at(robot)) pose = T_new_old * pose;
  }
}

PoseGraph optimized_graph(const FleetGraph& fleet, const FleetSolution& solution) {
  std::vector<const LoopOutcome*> used;
  for (const LoopOutcome& outcome : solution.loops) {
    if (outcome.in_use()) used.push_back(&outcome);
  }
  PoseGraph graph = build_graph(fleet, used);
  for (PoseGraph::Edge& edge : graph.edges) {
    const auto known = solution.variances.find(source_of(graph, edge));
    if (known != solution.variances.end()) edge.information /= known->second.variance;
  }
  std::size_t node = 0;
  for (const auto& [robot, poses] : solution.T_world_keyframe) {
    for (const Pose& pose : poses) graph.nodes[node++].pose = pose;
  }
  return graph;
}

}  // namespace

Fields fields_of(BackEndConfig& c) {
  Fields fields = {
      {"pcm_on", &c.pcm_on, "", 0, 0, "drop loops that disagree pairwise before the graph is solved"},
      {"gnc_on", &c.gnc_on, "", 0, 0, "let graduated non-convexity reject loops while the graph is solved"},
      {"cycles_needed", &c.cycles_needed, "", 0, 0,
       "take back merges that passed the merge check where merges with third robots contradict them"},
      {"balance_on", &c.balance_on, "", 0, 0,
       "weigh each robot's odometry, and the loops of each pair, by how well they fit the rest (adaptive)"},
      {"min_loops", &c.min_loops, "", 1, 10000, "loops in use that two robots need to share a map"}};
  append(fields, "cycles", fields_of(c.cycles));
  append(fields, "pcm", fields_of(c.pcm));
  append(fields, "gnc", fields_of(c.gnc));
  return fields;
}

FleetSolution solve(const FleetGraph& fleet, const BackEndConfig& config) {
  LoopSelection selection = select_loops(fleet, config);
  FleetSolution solution;
  solution.loops = std::move(selection.loops);
  solution.pairs = std::move(selection.pairs);

  std::vector<const LoopOutcome*> accepted;
  std::vector<const LoopOutcome*> consistent;
  for (const LoopOutcome& outcome : solution.loops) {
    accepted.push_back(&outcome);
    if (outcome.is_selected) consistent.push_back(&outcome);
  }
  solution.initial = build_graph(fleet, accepted);
  solution.after_pcm = build_graph(fleet, consistent);

  // First all robots that consistent loops link, solved together; what remains in use then says who shares a
  // map.
  for (LoopOutcome& outcome : solution.loops) outcome.weight = outcome.is_selected ? 1.0 : 0.0;
  for (const std::vector<RobotId>& group : linked_robots(fleet, solution.loops)) {
    solve_group(fleet, group, config, solution);
  }
  decide_merges(fleet, config, selection.of_pairs, solution);
  const std::vector<Component> solved_together = std::exchange(solution.components, {});
  for (const std::vector<RobotId>& group : linked_robots(fleet, solution.loops)) {
    const auto together = std::ranges::find_if(solved_together, [&](const Component& component) {
      return std::ranges::find(component.robots, group.front()) != component.robots.end();
    });
    solution.components.push_back(*together);
    solution.components.back().anchor = group.front();
    solution.components.back().robots = group;
    anchor_component(fleet, solution.components.back(), solution);
  }
  solution.optimized = optimized_graph(fleet, solution);
  return solution;
}

}  // namespace adit

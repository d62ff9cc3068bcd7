// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/merge_pictures.hpp"

#include <algorithm>

#include "adit/fleet/joint/frames.hpp"
#include "adit/fleet/joint/merge_accuracy.hpp"

namespace adit {
namespace {

LoopFate fate_of(const LoopOutcome& outcome) {
  if (outcome.in_use()) return LoopFate::in_use;
  return outcome.loop.is_free_to_slide() ? LoopFate::weak : LoopFate::refused;
}

std::vector<Vector3> odometry_of(const RobotGraph& robot, const Pose& T_frame_odom) {
  std::vector<Vector3> path;
  for (const GraphNode& node : robot.nodes) path.push_back(T_frame_odom * node.T_odom_base.translation());
  return path;
}

MergePicture::Hypothesis picture_of(const MergeHypothesis& h, const MergeCheck& check,
                                    const FleetGraph& fleet) {
  MergePicture::Hypothesis out;
  out.outcome = to_string(h.outcome);
  out.evidence = h.evidence;
  out.places_compared = static_cast<int>(h.num_checked);
  out.places_differing = static_cast<int>(h.num_differing());
  std::vector<const LoopClosure*> loops;
  for (const auto& [a, b] : h.loops) {
    const auto loop = fleet.loops.find({{check.a, a}, {check.b, b}});
    // Messages about a keyframe may come before the graph that it belongs to.
    const bool is_known =
        loop != fleet.loops.end() && fleet.knows(loop->second.from) && fleet.knows(loop->second.to);
    if (is_known) loops.push_back(&loop->second);
  }
  if (loops.empty()) return out;
  out.path = odometry_of(fleet.robots.at(check.b), mean_frame(fleet, loops));
  for (const LoopClosure* loop : loops) out.loops.push_back(out.path.at(loop->to.index));
  return out;
}

}  // namespace

LoopMap loop_map(const FleetGraph& fleet, const FleetSolution& solution) {
  LoopMap map;
  std::map<RobotId, std::size_t> place;
  for (std::size_t c = 0; c < solution.components.size(); ++c) {
    for (const RobotId robot : solution.components[c].robots) {
      LoopMap::Robot drawn{fleet.robots.at(robot).name, c, {}};
      for (const Pose& pose : solution.T_world_keyframe.at(robot)) drawn.path.push_back(pose.translation());
      place[robot] = map.robots.size();
      map.robots.push_back(std::move(drawn));
    }
  }
  for (const LoopOutcome& outcome : solution.loops) {
    const auto& [from, to] = std::pair(outcome.loop.from, outcome.loop.to);
    map.loops.push_back(
        {{place.at(from.robot), from.index}, {place.at(to.robot), to.index}, fate_of(outcome)});
    map.num_weak_in_use += outcome.in_use() && outcome.loop.is_free_to_slide() ? 1 : 0;
  }
  map.num_unregistered = static_cast<int>(std::ranges::count_if(
      fleet.loops, [](const auto& candidate) { return candidate.second.verdict != LoopVerdict::accepted; }));
  return map;
}

void mark_slips(LoopMap& map, const std::vector<std::shared_ptr<const RobotMap>>& robots) {
  for (LoopMap::Robot& drawn : map.robots) {
    const auto robot = std::ranges::find(robots, drawn.name, [](const auto& r) { return r->name; });
    if (robot == robots.end()) continue;
    const std::vector<Keyframe>& keyframes = (*robot)->keyframes;
    for (const SlipStretch& slip : (*robot)->slips) {
      // From the last keyframe before it to the first one after it.
      const auto first = std::ranges::upper_bound(keyframes, slip.begin, {}, &Keyframe::stamp);
      const auto last = std::ranges::lower_bound(keyframes, slip.end, {}, &Keyframe::stamp);
      const auto begin = std::max<std::ptrdiff_t>(first - keyframes.begin() - 1, 0);
      const auto end = std::min(last - keyframes.begin() + 1, std::ssize(drawn.path));
      if (begin < end) drawn.slips.emplace_back(drawn.path.begin() + begin, drawn.path.begin() + end);
    }
  }
}

std::vector<MergePicture> merge_pictures(const FleetGraph& fleet, const FleetSolution& solution) {
  std::vector<MergePicture> pictures;
  for (const auto& entry : fleet.checks) {
    const MergeCheck& check = entry.second;
    const auto pair = std::ranges::find_if(solution.pairs, [&](const PairOutcome& outcome) {
      return outcome.a == check.a && outcome.b == check.b;
    });
    if (pair == solution.pairs.end()) continue;
    MergePicture picture;
    picture.robots = {fleet.robots.at(check.a).name, fleet.robots.at(check.b).name};
    picture.merged = pair->merged;
    picture.verdict = pair->merged ? check.reason : pair->refused_reason;
    if (pair->accuracy) picture.verdict += "; " + to_string(*pair->accuracy);
    picture.evidence_needed = check.needed;
    picture.path = odometry_of(fleet.robots.at(check.a), Pose());
    for (const MergeHypothesis& h : check.hypotheses)
      picture.hypotheses.push_back(picture_of(h, check, fleet));
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

}  // namespace adit

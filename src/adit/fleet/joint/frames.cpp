// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/frames.hpp"

#include <algorithm>

#include "adit/core/disjoint_sets.hpp"
#include "adit/posegraph/chordal.hpp"

namespace adit {
namespace {

std::map<RobotPair, std::vector<const LoopClosure*>> loops_by_pair(
    const std::vector<const LoopClosure*>& loops) {
  std::map<RobotPair, std::vector<const LoopClosure*>> by_pair;
  for (const LoopClosure* loop : loops) by_pair[{loop->from.robot, loop->to.robot}].push_back(loop);
  return by_pair;
}

}  // namespace

Pose mean_frame(const FleetGraph& fleet, const std::vector<const LoopClosure*>& loops) {
  Matrix3 sum = Matrix3::Zero();
  Vector3 seen_in_a = Vector3::Zero();
  Vector3 seen_in_b = Vector3::Zero();
  for (const LoopClosure* loop : loops) {
    const Pose& T_oa_from = fleet.robots.at(loop->from.robot).nodes.at(loop->from.index).T_odom_base;
    const Pose& T_ob_to = fleet.robots.at(loop->to.robot).nodes.at(loop->to.index).T_odom_base;
    const Pose T_oa_to = T_oa_from * loop->T_from_to;
    sum += (T_oa_to * T_ob_to.inverse()).rotation_matrix();
    seen_in_a += T_oa_to.translation();
    seen_in_b += T_ob_to.translation();
  }
  const Matrix3 R = nearest_rotation(sum);
  return {R, (seen_in_a - R * seen_in_b) / static_cast<double>(loops.size())};
}

std::vector<std::vector<RobotId>> linked_robots(const FleetGraph& fleet,
                                                const std::vector<const LoopClosure*>& loops) {
  std::vector<RobotId> robots;
  for (const auto& [robot, graph] : fleet.robots) robots.push_back(robot);
  const auto position = [&](RobotId robot) {
    return static_cast<std::size_t>(std::ranges::lower_bound(robots, robot) - robots.begin());
  };
  DisjointSets sets(robots.size());
  for (const LoopClosure* loop : loops) sets.join(position(loop->from.robot), position(loop->to.robot));
  std::vector<std::vector<RobotId>> groups(robots.size());  // the group of a set is where its first robot is
  std::map<std::size_t, std::size_t> group_of_set;
  for (std::size_t i = 0; i < robots.size(); ++i)
    groups[group_of_set.try_emplace(sets.find(i), i).first->second].push_back(robots[i]);
  std::erase_if(groups, [](const std::vector<RobotId>& group) { return group.empty(); });
  return groups;
}

Frames common_frames(const FleetGraph& fleet, const std::vector<const LoopClosure*>& loops) {
  const auto by_pair = loops_by_pair(loops);
  Frames frames;
  for (const auto& [root, graph] : fleet.robots) {
    if (frames.contains(root)) continue;
    frames[root] = Pose();
    while (true) {
      const std::vector<const LoopClosure*>* widest = nullptr;
      RobotPair bridge;
      for (const auto& [pair, of_pair] : by_pair) {
        if (frames.contains(pair.first) == frames.contains(pair.second)) continue;
        if (widest != nullptr && of_pair.size() <= widest->size()) continue;
        widest = &of_pair;
        bridge = pair;
      }
      if (widest == nullptr) break;
      const Pose T_a_b = mean_frame(fleet, *widest);
      if (frames.contains(bridge.first)) {
        frames[bridge.second] = frames[bridge.first] * T_a_b;
      } else {
        frames[bridge.first] = frames[bridge.second] * T_a_b.inverse();
      }
    }
  }
  return frames;
}

}  // namespace adit

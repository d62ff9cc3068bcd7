// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/frames.hpp"

#include <Eigen/LU>

#include "adit/core/decompositions.hpp"

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
  const auto [u, singular_values, v] = svd(sum);
  Matrix3 flip = Matrix3::Identity();
  flip(2, 2) = (u * v.transpose()).determinant();
  const Matrix3 R = u * flip * v.transpose();
  return {R, (seen_in_a - R * seen_in_b) / static_cast<double>(loops.size())};
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

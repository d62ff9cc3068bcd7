// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/merge_accuracy.hpp"

#include <algorithm>

#include "adit/core/angles.hpp"
#include "adit/core/format.hpp"
#include "adit/posegraph/marginals.hpp"

namespace adit {
namespace {

// The first node of each robot in graphs of a solution.
std::map<RobotId, std::size_t> first_nodes(const FleetSolution& solution) {
  std::map<RobotId, std::size_t> first;
  std::size_t node = 0;
  for (const auto& [robot, poses] : solution.T_world_keyframe) {
    first[robot] = node;
    node += poses.size();
  }
  return first;
}

std::vector<const LoopClosure*> loops_in_use(const FleetSolution& solution, const PairOutcome& pair) {
  std::vector<const LoopClosure*> loops;
  for (const LoopOutcome& outcome : solution.loops)
    if (outcome.in_use() && outcome.loop.from.robot == pair.a && outcome.loop.to.robot == pair.b)
      loops.push_back(&outcome.loop);
  std::ranges::sort(loops, {}, [](const LoopClosure* loop) { return std::pair(loop->from, loop->to); });
  return loops;
}

MergeAccuracy accuracy_of(const LoopClosure& middle, const Matrix6& covariance, std::size_t num_loops) {
  const Vector6 sigma = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  return {sigma[0],  sigma[1],    sigma[2],  sigma.tail<3>().norm() / kDegree,
          num_loops, middle.from, middle.to, covariance};
}

// "0.034 m". Scans that are nearly the same (a part of a drive that is in the map) leave no residuals, and
// with them no noise; calibration, and the planes of a map whose points are some 0.2 m apart, are no better
// known than this.
std::string no_better_than_a_hundredth(double value, int digits, const char* unit) {
  constexpr double kLeast = 0.01;
  return value < kLeast ? format("under {} {}", kLeast, unit) : format("{:.{}f} {}", value, digits, unit);
}

}  // namespace

void measure_merges(FleetSolution& solution) {
  const Result<Marginals<Pose>> marginals = Marginals<Pose>::compute(solution.optimized);
  if (!marginals) return;
  const std::map<RobotId, std::size_t> first = first_nodes(solution);
  for (PairOutcome& pair : solution.pairs) {
    const std::vector<const LoopClosure*> loops = loops_in_use(solution, pair);
    if (!pair.merged || loops.empty()) continue;
    const LoopClosure& middle = *loops[loops.size() / 2];
    pair.accuracy = accuracy_of(
        middle, marginals->relative(first.at(pair.a) + middle.from.index, first.at(pair.b) + middle.to.index),
        loops.size());
  }
}

std::string to_string(const MergeAccuracy& accuracy) {
  std::string text = format("known to {} along, {} across and {} up, {}",
                            no_better_than_a_hundredth(accuracy.along_m, 3, "m"),
                            no_better_than_a_hundredth(accuracy.across_m, 3, "m"),
                            no_better_than_a_hundredth(accuracy.up_m, 3, "m"),
                            no_better_than_a_hundredth(accuracy.turn_deg, 2, "deg"));
  if (accuracy.num_loops == 1) text += "; one loop alone holds it: let both robots pass another common place";
  return text;
}

}  // namespace adit

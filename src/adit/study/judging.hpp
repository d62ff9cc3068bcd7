// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Judges merged maps by ground truth. No decision reads it.
#pragma once

#include <vector>

#include "adit/evaluation/study_result.hpp"
#include "adit/slam/meeting.hpp"
#include "adit/slam/true_surface.hpp"
#include "adit/study/robot_run.hpp"

namespace adit {

/// A solution of a meeting and the class of each of its loops.
struct JudgedSolution {
  FleetSolution solution;               ///< As it was given.
  std::vector<LoopClass> loop_classes;  ///< One per entry of solution.loops.
};
/// `runs` are the robots of the meeting, in its order. Fails on a loop with a robot that is not among them,
/// and where the truth does not cover a keyframe.
[[nodiscard]] Result<JudgedSolution> judge(const std::vector<const RobotRun*>& runs, const Meeting& meeting,
                                           const FleetSolution& solution);

/// The result of a meeting of two robots, without the policy's name; `pcm` is left as it is by default.
[[nodiscard]] PairResult pair_result(const std::vector<const RobotRun*>& runs, const Meeting& meeting,
                                     const JudgedSolution& judged);
/// The result of a meeting of any number of robots, without the policy's name, map accuracies and what
/// figures need.
[[nodiscard]] JointResult joint_result(const std::vector<const RobotRun*>& runs, const Meeting& meeting,
                                       const JudgedSolution& judged);

/// Each shared map of `joint`, the result of this meeting, against the true surface after the alignment of
/// its ATE; none of a map that could not be aligned or has no point.
[[nodiscard]] std::vector<std::optional<MapAccuracy>> map_accuracies(
    const std::vector<const RobotRun*>& runs, const Meeting& meeting, const JudgedSolution& judged,
    const JointResult& joint, const TrueSurface& surface, const SightConfig& config);

}  // namespace adit

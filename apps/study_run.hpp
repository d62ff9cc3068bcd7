// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The paper's experiment, stage by stage; apps/study.cpp puts them together and writes the results.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "adit/evaluation/study_result.hpp"
#include "meeting.hpp"

namespace adit::app {

/// One robot after its drive: its map (by the configured odometry), that of the paper's odometry, where its
/// policies are studied too, and what the evaluation needs.
struct RobotRun {
  std::shared_ptr<const RobotMap> map;
  std::shared_ptr<const RobotMap> paper_map;
  Trajectory truth;  ///< For evaluation alone.
  RobotResult result;

  /// The one that a policy selects keyframes of.
  [[nodiscard]] const std::shared_ptr<const RobotMap>& map_for(KeyframeSelection selection) const {
    return selection == KeyframeSelection::adaptive ? map : paper_map;
  }
};

/// Drives every recording once through RobotSlam with either odometry and, beside them, through KISS-ICP for
/// the comparison of section 3.1; robots in parallel.
Result<std::vector<RobotRun>> run_robots(const std::vector<Recording>& recordings, const RunConfig& config);

/// What a robot drove and how many scans and keyframes it made of that, without its odometries.
RobotResult robot_facts(const RobotMap& map, const Trajectory& truth);

/// What those robots' maps are under a keyframe policy.
std::vector<std::shared_ptr<const RobotMap>> selected_maps(const std::vector<const RobotRun*>& runs,
                                                           KeyframeSelection selection);

/// The keyframe policies of those names.
Result<std::vector<KeyframeSelection>> selections_of(const std::vector<std::string>& names);

/// What the ground truth says about one solution of a meeting.
struct JudgedSolution {
  FleetSolution solution;
  std::vector<LoopClass> loop_classes;  ///< One an entry of solution.loops.
};
Result<JudgedSolution> judge(const std::vector<const RobotRun*>& runs, const Meeting& meeting,
                             const FleetSolution& solution);

PairResult pair_result(const std::vector<const RobotRun*>& runs, const Meeting& meeting,
                       const JudgedSolution& judged);
JointResult joint_result(const std::vector<const RobotRun*>& runs, const Meeting& meeting,
                         const JudgedSolution& judged);

/// The optimized trajectory of a robot: its keyframes' stamps and poses in the common frame.
Trajectory solved_trajectory(const RobotMap& map, const std::vector<Pose>& T_world_keyframe);

}  // namespace adit::app

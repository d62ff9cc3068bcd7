// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/judging.hpp"

#include <algorithm>

#include "adit/evaluation/ate.hpp"
#include "adit/robot/keyframe_trajectory.hpp"

namespace adit {
namespace {

std::vector<Vector3> positions(const Trajectory& trajectory) {
  std::vector<Vector3> out;
  out.reserve(trajectory.size());
  for (const StampedPose& pose : trajectory) out.push_back(pose.T_world_body.translation());
  return out;
}

Trajectory keyframe_odometry(const RobotMap& map) {
  Trajectory trajectory;
  for (const Keyframe& keyframe : map.keyframes) trajectory.push_back({keyframe.stamp, keyframe.T_odom_base});
  return trajectory;
}

/// Each robot's keyframes as odometry has them, laid over the world by that robot's own alignment.
std::vector<std::vector<Vector3>> odometry_paths(const std::vector<const RobotRun*>& runs,
                                                 const Meeting& meeting) {
  std::vector<std::vector<Vector3>> paths;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const Trajectory odometry = keyframe_odometry(*meeting.maps[i]);
    const Result<AteResult> aligned = ate(odometry, runs[i]->truth);
    paths.push_back(aligned && aligned->positions.size() == odometry.size() ? aligned->positions
                                                                            : positions(odometry));
  }
  return paths;
}

template <class Keep>
GraphPicture picture(const std::vector<std::vector<Vector3>>& paths, const std::vector<const RobotRun*>& runs,
                     const JudgedSolution& judged, const Keep& keep) {
  const auto place_of = [&](RobotId id) {
    return static_cast<std::size_t>(
        std::ranges::find(runs, id, [](const RobotRun* run) { return run->map->id; }) - runs.begin());
  };
  GraphPicture drawn{paths, {}};
  for (std::size_t l = 0; l < judged.solution.loops.size(); ++l) {
    const LoopOutcome& outcome = judged.solution.loops[l];
    if (!keep(outcome)) continue;
    drawn.loops.push_back({paths[place_of(outcome.loop.from.robot)].at(outcome.loop.from.index),
                           paths[place_of(outcome.loop.to.robot)].at(outcome.loop.to.index),
                           judged.loop_classes[l]});
  }
  return drawn;
}

/// ATE of every robot: one alignment per connected component.
std::vector<MergedRobot> merged_robots(const std::vector<const RobotRun*>& runs, const Meeting& meeting,
                                       const FleetSolution& solution) {
  std::vector<MergedRobot> robots;
  for (const RobotRun* run : runs) robots.push_back({run->result.name, run->result.path_length_m, {}});
  for (const Component& component : solution.components) {
    std::vector<std::size_t> members;
    std::vector<Trajectory> estimates;
    std::vector<Trajectory> truths;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const RobotId id = runs[i]->map->id;
      if (std::ranges::find(component.robots, id) == component.robots.end()) continue;
      members.push_back(i);
      estimates.push_back(keyframe_trajectory(*meeting.maps[i], solution.T_world_keyframe.at(id)));
      truths.push_back(runs[i]->truth);
    }
    const Result<std::vector<AteResult>> errors = joint_ate(estimates, truths);
    for (std::size_t m = 0; errors && m < members.size(); ++m) robots[members[m]].ate = (*errors)[m];
  }
  return robots;
}

int wrong_in_use(const JudgedSolution& judged) {
  int wrong = 0;
  for (std::size_t l = 0; l < judged.solution.loops.size(); ++l) {
    wrong += judged.solution.loops[l].in_use() && judged.loop_classes[l] != LoopClass::correct ? 1 : 0;
  }
  return wrong;
}

}  // namespace

Result<JudgedSolution> judge(const std::vector<const RobotRun*>& runs, const Meeting& meeting,
                             const FleetSolution& solution) {
  const auto true_pose = [&](KeyframeId id) -> Result<Pose> {
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (runs[i]->map->id == id.robot) {
        const Stamp stamp = meeting.maps[i]->keyframes.at(id.index).stamp;
        return pose_at(runs[i]->truth, stamp).map_error([&](const Error& error) {
          return Error{runs[i]->result.name + ": " + error.message};
        });
      }
    }
    return fail("a loop names a robot that took no part");
  };
  JudgedSolution judged{solution, {}};
  for (const LoopOutcome& outcome : solution.loops) {
    const Result<Pose> from = true_pose(outcome.loop.from);
    const Result<Pose> to = true_pose(outcome.loop.to);
    if (!from) return tl::unexpected(from.error());
    if (!to) return tl::unexpected(to.error());
    judged.loop_classes.push_back(classify(outcome.loop, *from, *to));
  }
  return judged;
}

PairResult pair_result(const std::vector<const RobotRun*>& runs, const Meeting& meeting,
                       const JudgedSolution& judged) {
  PairResult result;
  const std::vector<MergedRobot> robots = merged_robots(runs, meeting, judged.solution);
  result.robots = {robots[0], robots[1]};
  for (std::size_t l = 0; l < judged.loop_classes.size(); ++l) {
    result.loops_before_pcm.add(judged.loop_classes[l]);
    if (judged.solution.loops[l].is_selected) result.loops_after_pcm.add(judged.loop_classes[l]);
  }
  result.wrong_loops_in_solution = wrong_in_use(judged);
  const PairOutcome& outcome = judged.solution.pairs.front();
  result.merged = outcome.merged;
  result.refused_kind = outcome.refused_kind;
  result.refused_reason = outcome.refused_reason;
  const std::vector<std::vector<Vector3>> paths = odometry_paths(runs, meeting);
  result.initial = picture(paths, runs, judged, [](const LoopOutcome&) { return true; });
  result.after_pcm = picture(paths, runs, judged, [](const LoopOutcome& loop) { return loop.is_selected; });
  std::vector<std::vector<Vector3>> solved;
  for (const MergedRobot& robot : robots)
    solved.push_back(robot.ate ? robot.ate->positions : std::vector<Vector3>{});
  for (std::size_t i = 0; i < solved.size(); ++i) {  // a picture needs every keyframe that a loop may name
    if (solved[i].size() != meeting.maps[i]->keyframes.size()) {
      solved[i] = positions(
          keyframe_trajectory(*meeting.maps[i], judged.solution.T_world_keyframe.at(runs[i]->map->id)));
    }
  }
  result.optimized = picture(solved, runs, judged, [](const LoopOutcome& loop) { return loop.in_use(); });
  return result;
}

JointResult joint_result(const std::vector<const RobotRun*>& runs, const Meeting& meeting,
                         const JudgedSolution& judged) {
  JointResult result;
  const auto name_of = [&](RobotId id) {
    return (*std::ranges::find(runs, id, [](const RobotRun* run) { return run->map->id; }))->result.name;
  };
  for (const Component& component : judged.solution.components) {
    std::vector<std::string>& names = result.components.emplace_back();
    for (const RobotId id : component.robots) names.push_back(name_of(id));
  }
  result.robots = merged_robots(runs, meeting, judged.solution);
  for (std::size_t l = 0; l < judged.loop_classes.size(); ++l) {
    if (judged.solution.loops[l].is_selected) result.loops.add(judged.loop_classes[l]);
  }
  result.wrong_loops_in_solution = wrong_in_use(judged);
  result.bytes_sent_per_robot = meeting.bytes_sent;
  for (const PairOutcome& pair : judged.solution.pairs) {
    if (pair.merged) continue;
    result.refusals.push_back(name_of(pair.a) + " and " + name_of(pair.b) + ": " + pair.refused_reason);
  }
  return result;
}

std::vector<std::optional<MapAccuracy>> map_accuracies(const std::vector<const RobotRun*>& runs,
                                                       const Meeting& meeting, const JudgedSolution& judged,
                                                       const JointResult& joint, const TrueSurface& surface,
                                                       const SightConfig& config) {
  std::vector<std::optional<MapAccuracy>> accuracies;
  for (const Component& component : judged.solution.components) {
    std::vector<TruedRobot> robots;
    std::optional<Pose> T_world_map;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const RobotId id = runs[i]->map->id;
      if (std::ranges::find(component.robots, id) == component.robots.end() || !joint.robots[i].ate) continue;
      T_world_map = joint.robots[i].ate->T_world_estimate;
      robots.push_back({meeting.maps[i].get(), judged.solution.T_world_keyframe.at(id), &runs[i]->truth});
    }
    std::optional<MapAccuracy>& accuracy = accuracies.emplace_back();
    if (!T_world_map) continue;
    if (const Result<MapAccuracy> found = accuracy_of(robots, *T_world_map, surface, config))
      accuracy = *found;
  }
  return accuracies;
}

}  // namespace adit

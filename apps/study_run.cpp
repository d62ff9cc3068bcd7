// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "study_run.hpp"

#include <chrono>
#include <mutex>

#include "adit/core/parallel.hpp"
#include "adit/evaluation/statistics.hpp"
#include "progress.hpp"

namespace adit::app {
namespace {

/// Milliseconds that `work` takes.
template <class Work>
double timed_ms(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

OdometryResult odometry_result(const std::string& method, const Trajectory& estimate, const Trajectory& truth,
                               const std::vector<double>& scan_ms) {
  OdometryResult result;
  result.method = method;
  if (const Result<AteResult> error = ate(estimate, truth)) result.ate = *error;
  if (!scan_ms.empty()) result.ms_per_scan_median = median(scan_ms);
  return result;
}

std::string json_name(OdometryMethod method) {
  std::string name(to_string(method));
  std::ranges::replace(name, '-', '_');
  return name;
}

/// A robot's drive under one odometry.
class Drive {
 public:
  Drive(const Recording& recording, RobotId id, RobotSlamConfig config, OdometryMethod method)
      : method_(method), slam_(id, recording.name, with_method(config, method), recording.T_base_lidar) {}

  void process(const Scan& scan, const std::optional<WheelDelta>& wheel) {
    RobotStep step;
    const double ms = timed_ms([&] { step = slam_.process(scan, wheel); });
    if (!step.keyframe) ms_.push_back(ms);
  }
  [[nodiscard]] OdometryMethod method() const { return method_; }
  [[nodiscard]] const RobotMap& map() const { return slam_.map(); }
  [[nodiscard]] OdometryResult result(const Trajectory& truth) const {
    return odometry_result(json_name(method_), slam_.map().odometry, truth, ms_);
  }

 private:
  static RobotSlamConfig with_method(RobotSlamConfig config, OdometryMethod method) {
    config.odometry.method = method;
    return config;
  }

  OdometryMethod method_;
  RobotSlam slam_;
  std::vector<double> ms_;  ///< Of scans that became no keyframe, so that it is the odometry's time alone.
};

Result<RobotRun> run_robot(const Recording& recording, RobotId id, const RunConfig& config,
                           Progress& progress) {
  const OdometryMethod method = config.robot.odometry.method;
  std::vector<Drive> drives;
  drives.emplace_back(recording, id, config.robot, method);
  if (config.paper_odometry != method)
    drives.emplace_back(recording, id, config.robot, config.paper_odometry);
  KissIcp kiss_icp(config.robot.odometry.kiss_icp, recording.T_base_lidar);
  const bool compare = std::ranges::find(drives, OdometryMethod::kiss_icp, &Drive::method) == drives.end();
  Trajectory kiss_trajectory;
  std::vector<double> kiss_ms;
  for (std::size_t i = 0; i < recording.num_scans(); ++i) {
    if (interrupted()) return fail(recording.name + ": interrupted");
    const Result<Scan> scan = recording.read_scan(i);
    if (!scan) return fail(recording.name, scan.error());
    const Result<std::optional<WheelDelta>> wheel = wheel_before(recording, i);
    if (!wheel) return fail(recording.name, wheel.error());
    for (Drive& drive : drives) drive.process(*scan, *wheel);
    if (compare) {
      OdometryStep kiss_step;
      kiss_ms.push_back(timed_ms([&] { kiss_step = kiss_icp.register_scan(*scan); }));
      kiss_trajectory.push_back({kiss_step.stamp, kiss_step.T_odom_base});
    }
    progress.advance();
  }
  RobotRun run;
  run.map = std::make_shared<const RobotMap>(drives.front().map());
  run.paper_map = drives.size() == 1 ? run.map : std::make_shared<const RobotMap>(drives.back().map());
  if (run.map->keyframes.empty() || run.paper_map->keyframes.empty())
    return fail(recording.name + ": no scan became a keyframe");
  run.truth = recording.truth;
  run.result = robot_facts(*run.map, run.truth);
  if (compare)
    run.result.odometry.push_back(odometry_result("kiss_icp", kiss_trajectory, run.truth, kiss_ms));
  for (auto drive = drives.rbegin(); drive != drives.rend(); ++drive)  // the paper's first
    run.result.odometry.push_back(drive->result(run.truth));
  return run;
}

/// The first robot that failed decides; the others' work is lost, but nothing of theirs is touched.
template <class T>
Result<std::vector<T>> all_or_first_error(std::vector<Result<T>> results) {
  std::vector<T> values;
  for (Result<T>& result : results) {
    if (!result) return tl::unexpected(result.error());
    values.push_back(std::move(*result));
  }
  return values;
}

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

/// ATE of every robot: one alignment a connected component.
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
      estimates.push_back(solved_trajectory(*meeting.maps[i], solution.T_world_keyframe.at(id)));
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

RobotResult robot_facts(const RobotMap& map, const Trajectory& truth) {
  RobotResult result;
  result.name = map.name;
  // What the robot drove while it recorded; its clock starts before the first whole sweep.
  Trajectory driven;
  for (const StampedPose& scan : map.odometry) {
    if (const Result<Pose> pose = pose_at(truth, scan.stamp)) driven.push_back({scan.stamp, *pose});
  }
  const Trajectory& path = driven.empty() ? map.odometry : driven;
  result.path_length_m = path_length(path);
  result.duration_s = to_seconds(map.odometry.back().stamp - map.odometry.front().stamp);
  result.scans = static_cast<int>(map.odometry.size());
  result.keyframes = static_cast<int>(map.keyframes.size());
  for (const StampedPose& pose : driven) result.route.push_back(pose.T_world_body.translation());
  return result;
}

Trajectory solved_trajectory(const RobotMap& map, const std::vector<Pose>& T_world_keyframe) {
  Trajectory trajectory;
  for (std::size_t k = 0; k < map.keyframes.size(); ++k) {
    trajectory.push_back({map.keyframes[k].stamp, T_world_keyframe[k]});
  }
  return trajectory;
}

Result<std::vector<RobotRun>> run_robots(const std::vector<Recording>& recordings, const RunConfig& config) {
  std::size_t num_scans = 0;
  for (const Recording& recording : recordings) num_scans += recording.num_scans();
  Progress progress("scans", num_scans);
  std::vector<Result<RobotRun>> runs(recordings.size(), fail("not run"));
  parallel_for_each(recordings.size(), [&](std::size_t i) {
    runs[i] = run_robot(recordings[i], {static_cast<std::uint8_t>(i)}, config, progress);
  });
  return all_or_first_error(std::move(runs));
}

std::vector<std::shared_ptr<const RobotMap>> selected_maps(const std::vector<const RobotRun*>& runs,
                                                           KeyframeSelection selection) {
  std::vector<std::shared_ptr<const RobotMap>> maps;
  for (const RobotRun* run : runs) {
    maps.push_back(std::make_shared<const RobotMap>(select_keyframes(*run->map_for(selection), selection)));
  }
  return maps;
}

Result<std::vector<KeyframeSelection>> selections_of(const std::vector<std::string>& names) {
  std::vector<KeyframeSelection> selections;
  for (const std::string& name : names) {
    const Result<KeyframeSelection> selection = keyframe_selection(name);
    if (!selection) return tl::unexpected(selection.error());
    selections.push_back(*selection);
  }
  return selections;
}

Result<JudgedSolution> judge(const std::vector<const RobotRun*>& runs, const Meeting& meeting,
                             const FleetSolution& solution) {
  const auto true_pose = [&](KeyframeId id) -> Result<Pose> {
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (runs[i]->map->id == id.robot) {
        return pose_at(runs[i]->truth, meeting.maps[i]->keyframes.at(id.index).stamp);
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
    if (judged.solution.loops[l].in_clique) result.loops_after_pcm.add(judged.loop_classes[l]);
  }
  result.wrong_loops_in_solution = wrong_in_use(judged);
  const PairOutcome& outcome = judged.solution.pairs.front();
  result.merged = outcome.merged;
  result.refused_reason = outcome.refused_reason;
  const std::vector<std::vector<Vector3>> paths = odometry_paths(runs, meeting);
  result.initial = picture(paths, runs, judged, [](const LoopOutcome&) { return true; });
  result.after_pcm = picture(paths, runs, judged, [](const LoopOutcome& loop) { return loop.in_clique; });
  std::vector<std::vector<Vector3>> solved;
  for (const MergedRobot& robot : robots)
    solved.push_back(robot.ate ? robot.ate->positions : std::vector<Vector3>{});
  for (std::size_t i = 0; i < solved.size(); ++i) {  // a picture needs every keyframe that a loop may name
    if (solved[i].size() != meeting.maps[i]->keyframes.size()) {
      solved[i] = positions(
          solved_trajectory(*meeting.maps[i], judged.solution.T_world_keyframe.at(runs[i]->map->id)));
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
    if (judged.solution.loops[l].in_clique) result.loops.add(judged.loop_classes[l]);
  }
  result.wrong_loops_in_solution = wrong_in_use(judged);
  result.bytes_sent_per_robot = meeting.bytes_sent;
  for (const PairOutcome& pair : judged.solution.pairs) {
    if (pair.merged) continue;
    result.refusals.push_back(name_of(pair.a) + " and " + name_of(pair.b) + ": " + pair.refused_reason);
  }
  return result;
}

}  // namespace adit::app

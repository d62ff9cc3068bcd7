// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/session_evaluation.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "adit/core/format.hpp"
#include "adit/io/tum.hpp"

namespace adit {
namespace {

std::size_t index_of(const SavedSession& session, std::string_view robot) {
  return static_cast<std::size_t>(std::ranges::find(session.robots, robot) - session.robots.begin());
}

/// Robot names that the file may state: its stem, its stem without a final word for truth, its folder.
std::vector<std::string> possible_names(const GivenTruth& truth) {
  if (!truth.robot.empty()) return {truth.robot};
  const std::filesystem::path path = truth.source;
  const std::string stem = path.stem().string();
  std::vector<std::string> names = {stem};
  for (const std::string_view word : {"truth", "gt", "ground_truth", "groundtruth"})
    for (const char separator : {'_', '-', '.'})
      if (const std::string end = separator + std::string(word); stem.ends_with(end))
        names.push_back(stem.substr(0, stem.size() - end.size()));
  names.push_back(path.parent_path().filename().string());
  return names;
}

Result<std::size_t> robot_of(const SavedSession& session, const GivenTruth& truth) {
  for (const std::string& name : possible_names(truth))
    if (const std::size_t robot = index_of(session, name); robot < session.robots.size()) return robot;
  return fail(format("{}: {} of the robots {}; give it as NAME={}", truth.source,
                     truth.robot.empty() ? "it names none" : "'" + truth.robot + "' is not one",
                     fmt::join(session.robots, ", "), truth.source));
}

std::string span_text(const Trajectory& trajectory) {
  return format("{} to {} s", stamp_text(trajectory.front().stamp), stamp_text(trajectory.back().stamp));
}

Result<> check_overlap(const std::string& robot, const Trajectory& driven, const GivenTruth& truth) {
  if (driven.empty()) return {};
  if (truth.trajectory.empty()) return fail(truth.source + ": holds no pose");
  const bool overlaps = truth.trajectory.front().stamp <= driven.back().stamp &&
                        driven.front().stamp <= truth.trajectory.back().stamp;
  if (overlaps) return {};
  return fail(format("{}: covers {}, and {} drove from {}: it is not the truth of this drive", truth.source,
                     span_text(truth.trajectory), robot, span_text(driven)));
}

/// One alignment for all robots of the component that have a truth.
Result<> add_joint_errors(const SavedSession& session, const std::vector<std::optional<Trajectory>>& truths,
                          const std::vector<std::string>& component, std::vector<RobotErrors>& robots) {
  std::vector<std::size_t> members;
  std::vector<Trajectory> estimates;
  std::vector<Trajectory> true_paths;
  for (const std::string& name : component) {
    const std::size_t robot = index_of(session, name);
    if (robot >= truths.size() || !truths[robot] || session.optimized[robot].empty()) continue;
    members.push_back(robot);
    estimates.push_back(session.optimized[robot]);
    true_paths.push_back(*truths[robot]);
  }
  if (members.empty()) return {};
  const Result<std::vector<AteResult>> errors = joint_ate(estimates, true_paths);
  if (!errors) return tl::unexpected(errors.error());
  for (std::size_t m = 0; m < members.size(); ++m) robots[members[m]].joint = (*errors)[m];
  return {};
}

Result<> add_own_errors(const SavedSession& session, std::size_t robot, const Trajectory& truth,
                        RobotErrors& errors) {
  if (session.odometry[robot].empty()) return {};
  const Result<AteResult> odometry = ate(session.odometry[robot], truth);
  if (!odometry) return fail(session.robots[robot], odometry.error());
  errors.odometry = *odometry;
  if (const Result<RpeResult> relative = rpe(session.optimized[robot], truth)) errors.relative = *relative;
  return {};
}

/// None where an end has no true pose.
std::optional<LoopClass> class_of(const SavedSession& session, const SavedLoop& saved,
                                  const std::vector<std::optional<Trajectory>>& truths) {
  const auto true_pose = [&](const std::string& name, Stamp stamp) -> std::optional<Pose> {
    const std::size_t robot = index_of(session, name);
    if (robot >= truths.size() || !truths[robot]) return std::nullopt;
    const Result<Pose> pose = pose_at(*truths[robot], stamp);
    return pose ? std::optional(*pose) : std::nullopt;
  };
  const std::optional<Pose> from = true_pose(saved.from_robot, saved.from_stamp);
  const std::optional<Pose> to = true_pose(saved.to_robot, saved.to_stamp);
  if (!from || !to) return std::nullopt;
  return classify(saved.loop, *from, *to);
}

void add_loops(const SavedSession& session, const std::vector<std::optional<Trajectory>>& truths,
               SessionEvaluation& evaluation) {
  for (const SavedLoop& saved : session.loops) {
    std::string& name = evaluation.loop_classes.emplace_back();
    if (saved.loop.verdict != LoopVerdict::accepted) continue;
    const std::optional<LoopClass> loop_class = class_of(session, saved, truths);
    if (!loop_class) {
      ++evaluation.num_unjudged;
      continue;
    }
    name = to_string(*loop_class);
    evaluation.registered.add(*loop_class);
    if (saved.in_clique) evaluation.consistent.add(*loop_class);
    if (saved.in_use()) evaluation.in_use.add(*loop_class);
  }
}

/// The robots of a shared map that have a truth, and the alignment of their ATE.
struct TruedMap {
  std::vector<TruedRobot> robots;
  Pose T_world_map;
};

TruedMap trued_map(const SessionEvaluation& evaluation, const std::vector<std::string>& names,
                   const PlacedSession& session, const std::vector<std::optional<Trajectory>>& truths) {
  TruedMap map;
  for (const std::string& name : names) {
    const std::size_t robot = index_of(session.saved, name);
    const auto placed =
        std::ranges::find(session.robots, name, [](const PlacedRobot& r) { return r.map->name; });
    if (placed == session.robots.end() || !evaluation.robots.at(robot).joint) continue;
    map.T_world_map = evaluation.robots[robot].joint->T_world_estimate;
    map.robots.push_back({placed->map.get(), placed->T_world_keyframe, &*truths.at(robot)});
  }
  return map;
}

}  // namespace

Result<std::vector<std::optional<Trajectory>>> match_truths(const SavedSession& session,
                                                            const std::vector<GivenTruth>& given) {
  std::vector<std::optional<Trajectory>> truths(session.robots.size());
  std::vector<std::string> sources(session.robots.size());
  for (const GivenTruth& truth : given) {
    const Result<std::size_t> robot = robot_of(session, truth);
    if (!robot) return tl::unexpected(robot.error());
    if (truths[*robot])
      return fail(format("{} and {} are both the truth of {}; give one of them", sources[*robot],
                         truth.source, session.robots[*robot]));
    const Result<> overlaps = check_overlap(session.robots[*robot], session.odometry[*robot], truth);
    if (!overlaps) return tl::unexpected(overlaps.error());
    truths[*robot] = truth.trajectory;
    sources[*robot] = truth.source;
  }
  return truths;
}

Result<SessionEvaluation> evaluate(const SavedSession& session,
                                   const std::vector<std::optional<Trajectory>>& truths) {
  SessionEvaluation evaluation;
  evaluation.components = session.components;
  for (const std::string& robot : session.robots) evaluation.robots.push_back({robot, {}, {}, {}});
  for (const std::vector<std::string>& component : session.components) {
    const Result<> added = add_joint_errors(session, truths, component, evaluation.robots);
    if (!added) return tl::unexpected(added.error());
  }
  for (std::size_t i = 0; i < truths.size(); ++i) {
    if (!truths[i]) continue;
    const Result<> added = add_own_errors(session, i, *truths[i], evaluation.robots[i]);
    if (!added) return tl::unexpected(added.error());
  }
  add_loops(session, truths, evaluation);
  return evaluation;
}

Result<> add_map_accuracy(SessionEvaluation& evaluation, const PlacedSession& session,
                          const std::vector<std::optional<Trajectory>>& truths, const TrueSurface& surface,
                          const SightConfig& config) {
  evaluation.maps.clear();
  for (const std::vector<std::string>& names : evaluation.components) {
    std::optional<MapAccuracy>& map = evaluation.maps.emplace_back();
    const TruedMap trued = trued_map(evaluation, names, session, truths);
    if (trued.robots.empty()) continue;
    const Result<MapAccuracy> accuracy = accuracy_of(trued.robots, trued.T_world_map, surface, config);
    if (!accuracy) return fail(format("the map of {}", fmt::join(names, ", ")), accuracy.error());
    map = *accuracy;
  }
  return {};
}

}  // namespace adit

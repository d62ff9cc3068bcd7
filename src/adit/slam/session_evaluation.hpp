// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Compares a session with ground truth that is given afterwards: trajectory errors of each robot, classes of
/// the loops.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adit/evaluation/ate.hpp"
#include "adit/evaluation/map_accuracy.hpp"
#include "adit/evaluation/rpe.hpp"
#include "adit/evaluation/tables.hpp"
#include "adit/io/session_dir.hpp"
#include "adit/slam/joint_map.hpp"
#include "adit/slam/true_surface.hpp"

namespace adit {

/// A true trajectory, T_world_base, as the user gave it.
struct GivenTruth {
  std::string source;     ///< What errors call it: its file.
  std::string robot;      ///< The robot that it was given for (NAME=FILE); "": its file name says.
  Trajectory trajectory;  ///< In the same world for all robots that share a map.
};

/// The truth of each robot of the session, in the session's order, whatever the order given; none for robots
/// without one. A file belongs to the robot that it is named after: robot_0.tum, robot_0_truth.tum,
/// robot_0_gt.tum, or robot_0/truth.tum. Fails on a truth that names no robot of the session, on two for one
/// robot, and on a truth that does not overlap its robot's drive in time: it cannot belong to it.
[[nodiscard]] Result<std::vector<std::optional<Trajectory>>> match_truths(
    const SavedSession& session, const std::vector<GivenTruth>& given);

/// Errors of one robot's trajectories; none of them without a truth.
struct RobotErrors {
  std::string name;                ///< As in the session.
  std::optional<AteResult> joint;  ///< After one alignment of all robots that share its map and have a truth.
  std::optional<AteResult> odometry;  ///< Of the odometry alone, after its own alignment.
  std::optional<RpeResult> relative;  ///< None where the path is shorter than a segment of 10 m.
};

/// What ground truth says of a session.
struct SessionEvaluation {
  std::vector<std::vector<std::string>> components;  ///< Names of the robots that share a map, as saved.
  /// Of each component against the true surface; none where no robot of it has a truth. Empty where no
  /// surface is given.
  std::vector<std::optional<MapAccuracy>> maps = {};
  std::vector<RobotErrors> robots;  ///< In the session's order; without errors where there is no truth.
  LoopCounts registered;            ///< Loops that registration accepted,
  LoopCounts consistent;            ///< of these those that PCM or the merge check kept,
  LoopCounts in_use;                ///< and of these those with a final weight of at least 0.5.
  int num_unjudged = 0;             ///< Registered loops with a keyframe that has no true pose.
  std::vector<std::string>
      loop_classes;  ///< Per row of loops.csv; "" where it is not registered or unjudged.
};
/// `truths` as `match_truths` returns them.
[[nodiscard]] Result<SessionEvaluation> evaluate(const SavedSession& session,
                                                 const std::vector<std::optional<Trajectory>>& truths);

/// Fills in `evaluation.maps`: each shared map, as its robots with a truth made it, after the alignment of
/// its ATE. `session` is the one that was evaluated. Fails as TrueSurface::compare does.
Result<> add_map_accuracy(SessionEvaluation& evaluation, const PlacedSession& session,
                          const std::vector<std::optional<Trajectory>>& truths, const TrueSurface& surface,
                          const SightConfig& config);

/// Two tables: trajectory errors, loops; a third one where maps were compared with the true surface.
[[nodiscard]] std::vector<Table> tables_of(const SessionEvaluation& evaluation);
/// The third of them for one map, which its only row calls `name`.
[[nodiscard]] Table table_of(const MapAccuracy& map, const std::string& name);
/// The same as JSON, with RPE.
[[nodiscard]] std::string json_of(const SessionEvaluation& evaluation);
/// One map, as it stands in the JSON of an evaluation.
[[nodiscard]] std::string json_of(const MapAccuracy& map);

/// Puts the classes into loops.csv of the session, and `evaluation` into its metrics.json.
Result<> save_evaluation(const std::filesystem::path& session, const SessionEvaluation& evaluation);

}  // namespace adit

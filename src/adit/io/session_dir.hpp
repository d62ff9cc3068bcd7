// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A session on disk: what `adit slam` made of some robots, in the layout of a session directory
/// (slam/saved_fleet.hpp has the rest of it): session.toml, ROBOT/{trajectory.tum,odometry.tum,map.ply},
/// map.ply, graph_*.g2o, loops.csv.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adit/evaluation/loop_stats.hpp"
#include "adit/fleet/joint/fleet_solution.hpp"
#include "adit/io/georeference.hpp"
#include "adit/robot/robot_map.hpp"

namespace adit {

/// How one robot of a session was mapped: what really ran, after any fallback.
struct RobotProvenance {
  std::string name;       ///< That of its folder in the session.
  std::string odometry;   ///< The method; "" of a robot that could not be mapped.
  std::string lidar;      ///< As the recording names it; "" when unknown.
  std::size_t scans = 0;  ///< Of its recording; 0 of a robot that could not be mapped.
  std::string failure;    ///< One line that names the robot; "" when it was mapped.
  /// The mount, if recorded clouds are in its frame (Recording::clouds_in_mount_frame); none where adit study
  /// or an earlier version mapped it.
  std::optional<Pose> T_base_lidar = {};

  /// Whether it is about the map of that name: a robot that failed may have had the name, too.
  [[nodiscard]] bool is_of_map(const std::string& map) const { return name == map && failure.empty(); }
};

/// Where a session came from: enough to make it again.
struct Provenance {
  std::string command;  ///< The command line, without where the session was written to.
  /// Of a session that went on from others: the commands that made those, in the order given.
  std::vector<std::string> earlier_commands = {};
  std::vector<std::string> inputs;      ///< As given.
  std::string world;                    ///< The mesh that robots were simulated in; "" for recordings.
  std::string profile = "default";      ///< What the configuration started from.
  std::vector<std::string> settings;    ///< Every --set, as given.
  std::uint64_t seed = 0;               ///< Of the simulation.
  std::string configuration;            ///< TOML of every field, as used.
  std::vector<RobotProvenance> robots;  ///< Also those that could not be mapped.
};

/// What is to be written. Maps and solution are of the same robots.
struct Session {
  Provenance provenance;                              ///< For session.toml.
  std::vector<std::shared_ptr<const RobotMap>> maps;  ///< In id order.
  FleetGraph fleet;                                   ///< With every registered candidate, accepted or not.
  FleetSolution solution;                             ///< Places the keyframes of all `maps`.
  std::vector<LoopClass> loop_classes;  ///< One per entry of solution.loops, or empty without ground truth.

  /// Of a robot in `fleet`.
  [[nodiscard]] const std::string& name_of(RobotId robot) const { return fleet.robots.at(robot).name; }
};

/// Whether a session on disk has its clouds: map.ply of each robot, and of all.
enum class MapFiles { write, leave_out };

/// Writes all files into `dir`, which exists (an OutputDir's path). With MapFiles::leave_out no clouds.
Result<> write_session(const std::filesystem::path& dir, const Session& session, MapFiles map_files);

/// All keyframe clouds of a robot in the common frame, thinned to one point a voxel.
[[nodiscard]] PointCloud merged_cloud(const RobotMap& map, const std::vector<Pose>& T_world_keyframe,
                                      double voxel);
/// The same of several robots together, each with the poses of its keyframes.
[[nodiscard]] PointCloud merged_cloud(const std::vector<std::shared_ptr<const RobotMap>>& maps,
                                      const std::vector<std::vector<Pose>>& T_world_keyframe, double voxel);

/// One line of loops.csv that was used in the solution or not, as far as evaluation needs it.
struct SavedLoop {
  /// Names of the robots.
  ///@{
  std::string from_robot, to_robot;
  ///@}
  /// Of the keyframes.
  ///@{
  Stamp from_stamp, to_stamp;
  ///@}
  LoopClosure loop;        ///< Without information, and without the robots of its ends.
  bool in_clique = false;  ///< LoopOutcome::is_selected.
  double weight = 0.0;     ///< LoopOutcome::weight; 0 where the loop took no part.

  /// Whether the solution kept it.
  [[nodiscard]] bool in_use() const { return weight >= 0.5; }
};

/// What `adit evaluate` and `adit info` read back.
struct SavedSession {
  std::string version;              ///< Of the adit that wrote it; "" where the file does not say.
  Provenance provenance;            ///< As SessionHeader has it.
  std::vector<std::string> robots;  ///< In id order.
  std::vector<std::vector<std::string>> components;  ///< Names that share one frame.
  std::vector<Trajectory> optimized;                 ///< One a robot.
  std::vector<Trajectory> odometry;         ///< The same, by odometry alone: T_odom_base of all scans.
  std::vector<SavedLoop> loops;             ///< All of loops.csv, in its order.
  std::vector<Georeference> georeferences;  ///< Of the maps that have one.
};
/// Fails where `dir` is no session, or a file of it is missing or damaged; errors name it. Robots without
/// keyframes have empty trajectories.
Result<SavedSession> read_session(const std::filesystem::path& dir);

}  // namespace adit

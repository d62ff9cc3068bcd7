// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// All results of a study, as plain data: the source of tables, figures, report.html and metrics.json.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "adit/core/point_cloud.hpp"
#include "adit/core/refusal_kind.hpp"
#include "adit/evaluation/ate.hpp"
#include "adit/evaluation/floor_plan.hpp"
#include "adit/evaluation/loop_stats.hpp"
#include "adit/evaluation/map_accuracy.hpp"

namespace adit {

/// One odometry method on one robot.
struct OdometryResult {
  std::string method;            ///< "kiss_icp", "kinematic_icp", "plane_icp".
  std::optional<AteResult> ate;  ///< After the robot's own alignment; none where there is no truth.
  std::optional<double> ms_per_scan_median;  ///< Time that passed per scan; none where it was not taken.

  /// As tables and figures call the method: "KISS-ICP"; the method itself where it has no other name.
  [[nodiscard]] std::string title() const;
};

/// One robot's drive, and how well each odometry followed it.
struct RobotResult {
  std::string name;                      ///< Unique in the study.
  double path_length_m = 0.0;            ///< By the truth over the time of the scans; without it by odometry.
  double duration_s = 0.0;               ///< From the first scan to the last.
  int scans = 0;                         ///< Those that odometry has a pose of.
  int keyframes = 0;                     ///< Of its map, as the study or session holds it.
  std::vector<OdometryResult> odometry;  ///< The configured one last; empty where none is compared.
  std::vector<Vector3> route;            ///< True positions in the world frame, for the figure of the routes.

  /// Metres per second, stops included; 0 of an empty drive.
  [[nodiscard]] double speed_mean_mps() const { return duration_s > 0.0 ? path_length_m / duration_s : 0.0; }
};

/// A loop as a line of a picture.
struct PictureLoop {
  Vector3 a;                                  ///< One end, in the frame of the picture.
  Vector3 b;                                  ///< The other end.
  LoopClass loop_class = LoopClass::correct;  ///< Its colour.
};

/// A pose graph as it is drawn: keyframe positions of each robot in the order driven, and the loops between
/// them, all in one frame.
struct GraphPicture {
  std::vector<std::vector<Vector3>> robot_paths;  ///< In the order of the result's robots.
  std::vector<PictureLoop> loops;                 ///< Their ends lie on the paths.

  /// Whether there is nothing to draw.
  [[nodiscard]] bool empty() const { return robot_paths.empty(); }
};

/// One robot of a merged (or refused) group.
struct MergedRobot {
  std::string name;            ///< As in `RobotResult`.
  double path_length_m = 0.0;  ///< As in `RobotResult`.
  /// After one alignment of all merged robots together; of a robot that was not merged, after its own.
  std::optional<AteResult> ate;

  /// None without an ATE or a path.
  [[nodiscard]] std::optional<double> ate_max_over_path_pct() const;
};

/// One robot pair under one keyframe policy, with or without PCM.
struct PairResult {
  std::array<MergedRobot, 2> robots;  ///< In the order of StudyResult::robots.
  std::string keyframes;              ///< "all", "tunnel_filter", "tunnel_filter_keep", "adaptive".
  bool pcm = true;                    ///< BackEndConfig::pcm_on of the solution.
  LoopCounts loops_before_pcm;        ///< All that registration accepted.
  LoopCounts loops_after_pcm;         ///< Those selected for the solution.
  int wrong_loops_in_solution = 0;    ///< Of either wrong class, with a final GNC weight of at least 0.5.
  bool merged = false;                ///< Both are in one map.
  RefusalKind refused_kind = RefusalKind::unknown;  ///< Where the pair was not merged.
  std::string refused_reason;  ///< One sentence where the pair was not merged, else empty.
  GraphPicture initial;        ///< All loops over the odometry.
  GraphPicture after_pcm;      ///< The loops that PCM kept, over the odometry.
  GraphPicture optimized;      ///< The solution; loops that the solver switched off are left out.

  /// Merged, and the largest ATE of both robots is below 1 % of their path lengths (the paper's rule).
  [[nodiscard]] bool success() const;
};

/// What became of a loop that registration accepted.
enum class LoopFate {
  in_use,
  refused,
  weak,  ///< Refused, and free to slide along the tunnel.
};

/// The paths of a fleet's robots in their maps, and the loops between them. Separate maps have no known
/// relative pose and are drawn side by side.
struct LoopMap {
  /// A robot and its path.
  struct Robot {
    std::string name;                              ///< As in `RobotResult`.
    std::size_t map = 0;                           ///< Robots with the same number share a frame.
    std::vector<Vector3> path;                     ///< Keyframe positions.
    std::vector<std::vector<Vector3>> slips = {};  ///< Stretches of it on which the wheels were not believed.
  };
  /// A keyframe.
  struct End {
    std::size_t robot = 0;  ///< Index in `robots`,
    std::size_t index = 0;  ///< and in its path.
  };
  /// A line between two keyframes.
  struct Loop {
    /// Keyframes of two robots, or of one.
    ///@{
    End from, to;
    ///@}
    LoopFate fate = LoopFate::refused;  ///< How the line is drawn.
  };
  std::vector<Robot> robots;  ///< Map by map.
  std::vector<Loop> loops;    ///< All that registration accepted.
  int num_weak_in_use = 0;    ///< Loops in use that are free to slide along the tunnel.
  int num_unregistered = 0;   ///< Candidates that registration refused; they have no line.
};

/// How the merge of two robots was decided: everything in the odometry frame of the first.
struct MergePicture {
  /// An alignment of the two maps that loops put forward, and what testing it has shown.
  struct Hypothesis {
    std::string outcome;         ///< As `to_string` of HypothesisOutcome spells it.
    double evidence = 0.0;       ///< Logarithmic; 0 where the hypothesis is refuted.
    int places_compared = 0;     ///< Where scans of both robots were laid over one another.
    int places_differing = 0;    ///< Of these, the ones where they do not show one place.
    std::vector<Vector3> path;   ///< Of the second robot if the hypothesis holds.
    std::vector<Vector3> loops;  ///< Where its loops lie on that path.
  };
  std::array<std::string, 2> robots;   ///< Names, as in `RobotResult`.
  bool merged = false;                 ///< In the solution, whatever the test alone had decided.
  std::string verdict;                 ///< One sentence: why, and what would resolve a refusal.
  double evidence_needed = 0.0;        ///< Below this evidence none is accepted.
  std::vector<Vector3> path;           ///< Of the first robot.
  std::vector<Hypothesis> hypotheses;  ///< The best one first.
};

/// All robots at once.
struct JointResult {
  std::string keyframes;  ///< The policy, as in `PairResult`.
  std::vector<std::vector<std::string>>
      components;                   ///< Names of the robots that share a map, one list per map.
  std::vector<MergedRobot> robots;  ///< In the order of StudyResult::robots.
  /// Of each component against the mesh of the world, none where it could not be compared; may be empty.
  std::vector<std::optional<MapAccuracy>> map_accuracy = {};
  LoopCounts loops;                                 ///< Those selected for the solution, before GNC.
  int wrong_loops_in_solution = 0;                  ///< As in `PairResult`.
  std::vector<std::uint64_t> bytes_sent_per_robot;  ///< In the order of `robots`; may be empty.
  std::vector<std::string> refusals;  ///< Of each pair that is not merged: "robot_0 and robot_3: ...".
  std::vector<PointCloud>
      maps;          ///< Each robot's map in the common frame, thinned, for the figure; may be empty.
  LoopMap loop_map;  ///< Of the joint solution.
  std::vector<MergePicture> merges;  ///< Of pairs whose merge was tested.
};

/// All that was measured in one world, or in one session.
struct StudyResult {
  std::string version;                ///< Of adit.
  std::string world;                  ///< Its name; empty where none was simulated.
  std::string lidar;                  ///< Names of the simulated LiDARs; empty likewise.
  std::uint64_t seed = 0;             ///< Of the noise of all sensors.
  double wall_s = 0.0;                ///< Time that passed; 0 where it was not taken.
  double peak_rss_mb = 0.0;           ///< Most memory of the process; 0 where it was not taken.
  std::vector<RobotResult> robots;    ///< In the order of their ids.
  std::vector<PairResult> pairs;      ///< Pair by pair, each under every policy, without and with PCM.
  std::optional<JointResult> joint;   ///< None where there was nothing to join.
  FloorPlan floor_plan;               ///< The world's walls from above; may be empty.
  std::string configuration;          ///< TOML, as it was used.
  std::string command;                ///< The command line that makes this study again; may be empty.
  std::vector<std::string> what_ran;  ///< One line per fact: odometry of each robot, policies, inputs.
};

/// The pair result of two robots (by index of `robots`, in that order), or null.
[[nodiscard]] const PairResult* find_pair(const StudyResult& study, std::array<std::string, 2> robots,
                                          const std::string& keyframes, bool pcm);

}  // namespace adit

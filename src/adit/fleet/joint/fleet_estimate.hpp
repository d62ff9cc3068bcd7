// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "adit/fleet/joint/fleet_solution.hpp"
#include "adit/posegraph/robust_incremental.hpp"

namespace adit {

/// The poses of all keyframes that a robot knows of, kept up to date while messages come: what it navigates
/// by between two solutions. New keyframes and loops are added to the graph of their map, and what they
/// change is solved (RobustIncremental). A map is begun anew where robots join it or a merge is taken back.
/// Selecting loops and copying poses takes time in proportion to all that is known.
///
/// `solve` weighs all loops together and depends on nothing but what is known; this depends on the order in
/// which it came, and only follows `solve` (`difference`). The loop that joins two robots
/// first is not doubted here, as nothing else is known of their frames: merges are decided beforehand
/// (`select_loops`).
class FleetEstimate {
 public:
  /// What one update did.
  struct Step {
    std::size_t num_keyframes = 0;   ///< Added.
    std::size_t num_begun_anew = 0;  ///< Maps.
    int iterations = 0;              ///< Linear systems solved, in all maps.
    /// One sentence for each map that could not be solved; its poses stay as they were.
    std::vector<std::string> problems;
  };
  /// Brings the estimate up to what is known now. What was known before must still be known. Where it throws,
  /// the next call begins all maps anew.
  Step update(const FleetGraph& known, const BackEndConfig& config);

  /// In the odometry frame of the robot with the smallest id in the same map. Robots without keyframes are
  /// left out.
  [[nodiscard]] const std::map<RobotId, std::vector<Pose>>& T_map_keyframe() const { return poses_; }
  /// Robots that share a map, each group in ascending order.
  [[nodiscard]] std::vector<std::vector<RobotId>> maps() const;
  /// Whether a loop holds its map together.
  [[nodiscard]] bool is_in_use(const KeyframePair& ends) const;

 private:
  struct Map {
    RobustIncremental<Pose> graph;
    std::map<RobotId, std::vector<std::size_t>> nodes;  ///< Of the graph, by keyframe.
    std::map<KeyframePair, std::size_t> loops;          ///< Edges of the graph.
  };
  using Loops = std::vector<const LoopClosure*>;

  [[nodiscard]] static bool can_grow(const Map& map, const Loops& loops);
  [[nodiscard]] static Map begin(const FleetGraph& known, const std::vector<RobotId>& robots,
                                 const Loops& loops);
  static void add_keyframes(Map& map, RobotId robot, const RobotGraph& own, const Pose& T_map_odom);
  static void add_loop(Map& map, const LoopClosure& loop, EdgeKind kind);
  void solve(Map& map, Step& step);

  std::map<std::vector<RobotId>, Map> maps_;
  std::map<RobotId, std::vector<Pose>> poses_;
};

/// How far an estimate is from a solution of what the same robot knows.
struct EstimateDifference {
  double largest_m = 0.0;                ///< Of all keyframes.
  std::size_t num_judged_otherwise = 0;  ///< Loops in use in one of the two alone.
};
/// All keyframes of the estimate have to be in `solution`.
[[nodiscard]] EstimateDifference difference(const FleetEstimate& estimate, const FleetSolution& solution);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// How well the fleet decides which maps belong together, over many worlds: what became of each pair of
/// robots, judged by the ground truth, and the tables that say it in short.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "adit/evaluation/tables.hpp"

namespace adit {

/// Metres of a shared stretch, and places on it that are like no other, from which on a pair counts as one
/// that should be merged.
inline constexpr double kMergeableShare = 25.0;
inline constexpr int kMergeablePlaces = 1;

enum class MergeOutcome {
  success,  ///< Merged, and the largest ATE of every robot is below 1 % of its path (the paper's rule).
  bent,     ///< Merged in the right place, but less exact than that: the odometry was no better.
  refused,  ///< Not merged.
  wrong,    ///< Merged in a wrong place: what must never happen.
};
[[nodiscard]] std::string_view to_string(MergeOutcome outcome);
/// The outcome of that name; throws ContractViolation when there is none.
[[nodiscard]] MergeOutcome merge_outcome(std::string_view name);

/// What the ground truth says of the robots that one solution put together.
struct MergeEvidence {
  struct Robot {
    double path_length_m = 0.0;
    double ate_max_m = 0.0;  ///< After one alignment of all robots of the map together.
    double drift_m = 0.0;    ///< Of its odometry (largest_drift_m).
  };
  bool merged = false;
  int loops_in_use = 0;
  int wrong_loops_in_use = 0;
  std::vector<Robot> robots;
};

/// A merge that fails the 1 % rule is wrong when half of the loops that hold it are, or when it left a robot
/// more than a metre and twice as far off as the worst of the odometries alone; else it is bent.
[[nodiscard]] MergeOutcome judge_merge(const MergeEvidence& evidence);

/// Whether every map lies within one of `groups`. All are lists of robot names.
[[nodiscard]] bool are_within(const std::vector<std::vector<std::string>>& maps,
                              const std::vector<std::vector<std::string>>& groups);

/// One pair of robots under one keyframe policy, merged by itself.
struct MergePair {
  std::array<std::string, 2> robots;
  double shared_m = 0.0;
  int distinctive_places = 0;  ///< On the stretch, to both of them.
  MergeOutcome outcome = MergeOutcome::refused;
  std::string refused_reason;  ///< One sentence where it was refused.
  int registrations = 0;
  int loops_in_use = 0;
  int wrong_loops_in_use = 0;
  std::array<double, 2> ate_max_m{};
  std::array<double, 2> ate_max_over_path_pct{};

  [[nodiscard]] bool shares_enough() const { return shared_m >= kMergeableShare; }
  [[nodiscard]] bool mergeable() const { return shares_enough() && distinctive_places >= kMergeablePlaces; }
};

/// All robots of a world at once. Maps are lists of robot names.
struct MergeJoint {
  std::vector<std::vector<std::string>> maps;
  std::vector<std::vector<std::string>> possible_maps;  ///< What chains of mergeable pairs join.
  bool wrong = false;  ///< A map is wrong by `judge_merge`, or holds robots that no shared stretch joins.
  int wrong_loops_in_use = 0;
  double ate_max_m = 0.0;
  double ate_max_over_path_pct = 0.0;  ///< The worst robot's.
};

/// One world under one keyframe policy.
struct MergeRun {
  std::string world;
  std::string group;  ///< "tuning", "check" or "limit".
  std::string keyframes;
  std::vector<MergePair> pairs;
  MergeJoint joint;
  int registrations = 0;  ///< Candidates registered between all robots.
  double time_s = 0.0;    ///< Processor time from the robots' maps to the joint solution.
};

/// The sums of some runs.
struct MergeCounts {
  int worlds = 0;
  int mergeable = 0, success = 0, bent = 0,
      refused = 0;                            ///< Pairs that should be merged, and what became of them.
  int indistinct = 0, indistinct_merged = 0;  ///< Pairs that share enough, but no distinctive place.
  int others = 0, kept_apart = 0;             ///< Pairs that share less.
  int wrong = 0;                              ///< Of all pairs.
  int wrong_loops = 0, joint_wrong_loops = 0, joint_wrong = 0, joint_whole = 0;
  int joint_merged = 0;  ///< Mergeable pairs that share a map with all robots of the world, and a right one.
  int registrations = 0;
  double time_s = 0.0;

  void add(const MergeRun& run);
};

/// Summary of each group and policy; each world; the wrong merges; the pairs that share enough and were
/// refused, with the reason. The last two only where there are any; worlds and refusals of policies as they
/// are, not of those with a second word in their name, which leave something out.
[[nodiscard]] std::vector<Table> merge_tables(const std::vector<MergeRun>& runs);

}  // namespace adit

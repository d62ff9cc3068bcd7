// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// How well the fleet decides which maps belong together, over many worlds: the outcome of each pair of
/// robots, judged by ground truth, and its tables.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "adit/core/refusal_kind.hpp"
#include "adit/evaluation/tables.hpp"

namespace adit {

/// A pair counts as mergeable from this length of shared stretch on, metres, and this much of it within
/// stretches whose surface differs from that of every other.
///@{
inline constexpr double kMergeableStretch = 25.0;
inline constexpr double kDistinctiveStretch = 20.0;
///@}

/// What became of two robots, by ground truth.
enum class MergeOutcome {
  success,  ///< Merged, and the largest ATE of every robot is below 1 % of its path (the paper's rule).
  bent,     ///< Merged in the correct place, but less exactly: the odometry was no better.
  refused,  ///< Not merged.
  wrong,    ///< Merged in a wrong place, which must never happen.
};
[[nodiscard]] std::string_view to_string(MergeOutcome outcome);  ///< As the values are spelled.
/// The outcome of that name; throws ContractViolation for an unknown one.
[[nodiscard]] MergeOutcome merge_outcome(std::string_view name);

/// What ground truth says about the robots that one solution merged.
struct MergeEvidence {
  /// One of the robots merged.
  struct Robot {
    double path_length_m = 0.0;  ///< By the truth.
    double ate_max_m = 0.0;      ///< After one alignment of all robots of the map together.
    double drift_m = 0.0;        ///< Of its odometry (largest_drift_m).
  };
  bool merged = false;         ///< Else the outcome is refused, whatever the rest says.
  int loops_in_use = 0;        ///< With a final weight of one half or more.
  int wrong_loops_in_use = 0;  ///< Of these, the ones of either wrong class.
  std::vector<Robot> robots;   ///< Those that share a map with another.
};

/// A merge that fails the 1 % rule is wrong when at least half of its loops in use are, or when the largest
/// ATE exceeds 1.5 times the worst drift of its robots' odometries plus a metre; else it is bent.
[[nodiscard]] MergeOutcome judge_merge(const MergeEvidence& evidence);

/// Whether every map lies within one of `groups`. All are lists of robot names.
[[nodiscard]] bool are_within(const std::vector<std::vector<std::string>>& maps,
                              const std::vector<std::vector<std::string>>& groups);

/// One pair of robots under one keyframe policy, merged by itself.
struct MergePair {
  std::array<std::string, 2> robots;                ///< Their names; figures of both stand in this order.
  double shared_m = 0.0;                            ///< Length of the stretch that both drove, by the truth.
  double distinctive_m = 0.0;                       ///< Of the shared stretch, by geometry alone.
  MergeOutcome outcome = MergeOutcome::refused;     ///< By `judge_merge`.
  RefusalKind refused_kind = RefusalKind::unknown;  ///< Where it was refused.
  std::string refused_reason;                       ///< One sentence where it was refused.
  int registrations = 0;              ///< Candidates registered between the two or within one's own map.
  int loops_in_use = 0;               ///< As in `MergeEvidence`.
  int wrong_loops_in_use = 0;         ///< As in `MergeEvidence`.
  std::array<double, 2> ate_max_m{};  ///< After one alignment of both, or of each where refused.
  std::array<double, 2> ate_max_over_path_pct{};  ///< Of these, per cent of the robot's own path.

  /// Whether their paths alone would allow a merge.
  [[nodiscard]] bool shares_enough() const { return shared_m >= kMergeableStretch; }
  /// Whether their paths and surroundings would.
  [[nodiscard]] bool mergeable() const { return shares_enough() && distinctive_m >= kDistinctiveStretch; }
};

/// All robots of a world at once. Maps are lists of robot names.
struct MergeJoint {
  std::vector<std::vector<std::string>> maps;           ///< Each robot in one; alone where nothing joins it.
  std::vector<std::vector<std::string>> possible_maps;  ///< What chains of mergeable pairs join.
  bool wrong = false;  ///< A map is wrong by `judge_merge`, or holds robots that no shared stretch joins.
  int wrong_loops_in_use = 0;          ///< Of either wrong class, over all robots.
  double ate_max_m = 0.0;              ///< The worst robot's, after the alignment of its map.
  double ate_max_over_path_pct = 0.0;  ///< The worst robot's.
};

/// One world under one keyframe policy.
struct MergeRun {
  std::string world;             ///< As in the list of worlds.
  std::string group;             ///< Of the world, as the list of worlds has it.
  std::string keyframes;         ///< The policy; a variant has a second word.
  std::string sensors;           ///< Names of the LiDARs that robots have in turn.
  std::string conditions;        ///< Under which they were simulated: "ideal", "field", or else "other".
  std::vector<MergePair> pairs;  ///< Each two robots, the first with all others first.
  MergeJoint joint;              ///< All robots at once.
  int registrations = 0;         ///< Candidates registered between robots or within the map of one.
  double time_s = 0.0;           ///< Processor time from the robots' maps to the joint solution.
};

/// The sums of some runs.
struct MergeCounts {
  int worlds = 0;  ///< Runs.
  /// Mergeable pairs and their outcomes.
  ///@{
  int mergeable = 0, success = 0, bent = 0, refused = 0;
  ///@}
  /// Pairs that share enough, but no distinctive stretch; those that were merged, not wrongly.
  ///@{
  int indistinct = 0, indistinct_merged = 0;
  ///@}
  /// Pairs that share less; those that were refused.
  ///@{
  int others = 0, kept_apart = 0;
  ///@}
  int wrong = 0;              ///< Of all pairs.
  int wrong_loops = 0,        ///< In use, of either wrong class, over the pairs;
      joint_wrong_loops = 0,  ///< over the joint solutions.
      joint_wrong = 0,        ///< Worlds whose joint solution is wrong.
      joint_whole = 0;        ///< Worlds whose joint maps are right and none could be larger.
  int joint_merged = 0;       ///< Mergeable pairs in one correct map after all robots of the world met.
  /// All pairs; those that were merged, well or not.
  ///@{
  int pairs = 0, merged = 0;
  ///@}
  int joint_pairs = 0;                               ///< All pairs that end in one map after all robots met.
  std::array<int, kRefusalKinds.size()> refusals{};  ///< Of mergeable pairs, by what kept them apart.
  int registrations = 0;                             ///< As in `MergeRun`.
  double time_s = 0.0;                               ///< As in `MergeRun`.

  /// Counts one run.
  void add(const MergeRun& run);
};

/// Summary of each group, policy, sensor and condition; each world; sums by the sensors of a pair, where
/// robots of a world have different ones; the wrong merges; what kept mergeable pairs apart; the pairs that
/// share enough and were refused, with the reason. The last three only where there are any. Variants, which
/// have a second word after the policy's name, appear in the summary, among the wrong merges and in what kept
/// pairs apart only.
[[nodiscard]] std::vector<Table> merge_tables(const std::vector<MergeRun>& runs);

}  // namespace adit

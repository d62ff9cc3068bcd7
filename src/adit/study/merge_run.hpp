// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Measures merging in one world under one keyframe policy.
#pragma once

#include <filesystem>
#include <vector>

#include "adit/evaluation/merge_result.hpp"
#include "adit/study/distinctive_stretch.hpp"
#include "adit/study/judging.hpp"

namespace adit {

/// What the ground truth says about the robots of one world.
struct MergeTruth {
  std::vector<std::vector<double>> shared_m;  ///< [a][b]: length of the shared stretch, metres.
  DistinctiveMetres distinctive_m;            ///< As distinctive_stretches.
  std::vector<double> drift_m;                ///< Of each robot's odometry (largest_drift_m).
};
/// Drift is that of the maps that the policy `selection` works on. Fails where a trajectory has no truth.
Result<MergeTruth> merge_truth(const std::vector<RobotRun>& runs, KeyframeSelection selection,
                               DistinctiveMetres distinctive_m);

/// All robots meet once under the policy of `config`; then every pair is solved by itself on the loops that
/// it found, and all jointly. Ground truth only judges the result.
Result<MergeRun> run_merges(const std::vector<RobotRun>& runs, const MergeTruth& truth,
                            const SlamConfig& config);

/// The results file holds all runs so far; a missing file holds none.
///@{
Result<std::vector<MergeRun>> read_merge_runs(const std::filesystem::path& file);
Result<> write_merge_runs(const std::filesystem::path& file, const std::vector<MergeRun>& runs);
///@}
/// One line per pair, for spreadsheets.
Result<> write_merge_csv(const std::filesystem::path& file, const std::vector<MergeRun>& runs);
/// Whether both are of one world, policy, sensors and conditions, so that the later one replaces the other.
[[nodiscard]] bool is_same_run(const MergeRun& a, const MergeRun& b);
/// Replaces the run that `is_same_run`, or appends.
void put_run(std::vector<MergeRun>& runs, MergeRun run);

}  // namespace adit

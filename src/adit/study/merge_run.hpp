// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What one world shows about merging under one keyframe policy.
#pragma once

#include <filesystem>
#include <vector>

#include "adit/evaluation/merge_result.hpp"
#include "adit/study/distinctive_places.hpp"
#include "adit/study/judging.hpp"

namespace adit {

/// What the ground truth says about the robots of one world.
struct MergeTruth {
  std::vector<std::vector<double>> shared_m;  ///< [a][b], metres.
  DistinctivePlaces distinctive_places;
  std::vector<double> drift_m;  ///< Of each robot's odometry (largest_drift_m).
};
Result<MergeTruth> merge_truth(const std::vector<RobotRun>& runs, KeyframeSelection selection,
                               DistinctivePlaces distinctive_places);

/// All robots meet once under the policy of `config`; then every pair is solved by itself on the loops that
/// it found, and all jointly. Neither sees the ground truth; it only judges.
Result<MergeRun> run_merges(const std::vector<RobotRun>& runs, const MergeTruth& truth,
                            const SlamConfig& config);

/// The results file: all runs that there have been. A missing file holds none.
Result<std::vector<MergeRun>> read_merge_runs(const std::filesystem::path& file);
Result<> write_merge_runs(const std::filesystem::path& file, const std::vector<MergeRun>& runs);
/// One line per pair, for spreadsheets.
Result<> write_merge_csv(const std::filesystem::path& file, const std::vector<MergeRun>& runs);
/// Puts the run in the place of the one of the same world and policy, or at the end.
void put_run(std::vector<MergeRun>& runs, MergeRun run);

}  // namespace adit

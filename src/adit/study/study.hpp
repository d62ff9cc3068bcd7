// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The paper's whole experiment on one world: odometry comparison, every pair of robots under every keyframe
/// policy with and without PCM, and all robots jointly.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/evaluation/tables.hpp"
#include "adit/io/session_dir.hpp"
#include "adit/slam/run_config.hpp"
#include "adit/study/robot_run.hpp"

namespace adit {

/// What is run, and where results go.
struct Study {
  RunConfig config;                         ///< Policies run under `with_policy`.
  std::vector<KeyframeSelection> policies;  ///< Of the pairs; the last one also of all robots jointly.
  Provenance provenance;                    ///< Of the sessions and the report; robots are filled in.
  std::filesystem::path folder;             ///< Existing folder for all output.
};

/// Drives the robots of the world and merges their maps. Writes into the folder each robot's trajectories
/// (robots/), the session of each pair (pairs/A-B/POLICY/) and the joint one (joint/). Reports phases of
/// progress; may throw `Cancelled` (core/progress.hpp). Times are left at zero: they are the caller's.
[[nodiscard]] Result<StudyResult> run_study(const Study& study, const World& world);

/// The paper's figures stand beside adit's where the study is of the paper's kind: four robots in zab.
[[nodiscard]] std::vector<Table> tables_of(const StudyResult& result);

/// Writes tables.md, metrics.json, report.html and figures/ (SVG and PNG).
Result<> write_study_report(const StudyResult& result, const std::vector<Table>& tables,
                            const std::filesystem::path& folder);

}  // namespace adit

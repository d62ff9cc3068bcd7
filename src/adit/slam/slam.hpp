// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Multi-robot SLAM in one call: recordings in, one session out.
///
///     std::vector<adit::Recording> recordings = ...;          // adit::open_recording(path), one per robot
///     const adit::Result<adit::SlamRun> run = adit::slam(recordings, adit::SlamConfig{});
///     if (!run) return report(run.error().message);
///     for (const adit::PairOutcome& pair : run->session.solution.pairs)
///       ...                                                   // merged, or refused with a reason
///     adit::write_slam("session", *run);                      // maps, trajectories, graphs, report.html
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "adit/io/session_dir.hpp"
#include "adit/slam/mapping.hpp"

namespace adit {

struct SlamRun {
  Session session;  ///< Its provenance says what ran; the caller fills in command and inputs.
  std::vector<std::uint64_t> bytes_sent;  ///< Per robot of the session.
  EstimateDifference online;              ///< Of the first robot's estimate, kept from meeting to meeting.
  std::vector<FailedRobot> failed;        ///< Recordings that could not be mapped; the others went on.
  std::vector<std::string> notes;         ///< Fallbacks, changed names, messages left out, one line each.
};

/// Maps every robot, lets each meet every other, and solves for the joint maps. With the default
/// configuration maps are merged only where tested evidence says so; a pair that is not merged has its reason
/// in `session.solution.pairs`. Names are made safe and distinct (core/robot_name). The same recordings and
/// configuration give the same bytes with any number of threads. Ground truth in recordings is not read.
/// Reports its phases to the observer in scope and may throw `Cancelled` (core/progress.hpp); fails as
/// `map_robots` does.
[[nodiscard]] Result<SlamRun> slam(std::vector<Recording> recordings, const SlamConfig& config = {});

/// Writes the session directory (docs/architecture.md) into `dir`, which exists: an OutputDir's path, or any
/// folder.
Result<> write_slam(const std::filesystem::path& dir, const SlamRun& run);

}  // namespace adit

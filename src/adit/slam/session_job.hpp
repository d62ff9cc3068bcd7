// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What makes a session, from recordings or from earlier sessions.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/slam/run_config.hpp"
#include "adit/slam/slam.hpp"

namespace adit {

/// What is to run, and the provenance that the session will state.
struct Job {
  RunConfig config;       ///< Of the mapping and of how recordings are read.
  Provenance provenance;  ///< Without robots, which the run adds.
};

/// Sessions to go on from.
struct SavedSessions {
  std::vector<SavedFleet> fleets;  ///< In the order of the paths.
  Job job;  ///< With the configuration of the first, and a note where that of another one differs.
};
/// Reads session directories. Fails as read_fleet does. Settings that this version does not know, as those of
/// another one, are noted.
[[nodiscard]] Result<SavedSessions> open_sessions(const std::vector<std::string>& paths);

/// Writes the session into `dir`, which exists, with the provenance and the configuration of the job.
Result<> write_slam(const std::filesystem::path& dir, SlamRun& run, Job job);

}  // namespace adit

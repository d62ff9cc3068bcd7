// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What commands share that make a session, from recordings or from earlier sessions.
#pragma once

#include <string>
#include <vector>

#include "adit/io/atomic_file.hpp"
#include "adit/slam/session_job.hpp"
#include "adit/slam/slam.hpp"
#include "command_line.hpp"

namespace adit::app {

/// Ends the command where it was given a configuration: a session goes on with its own.
void refuse_configuration(const Common& common);

/// Pairs "A,B" of robots.
struct RulingOptions {
  std::vector<std::string> vetoes;
  std::vector<std::string> confirmed;
};
/// --veto and --confirm.
void add_ruling_options(const Command& command, RulingOptions& options);
/// Wrong usage where a pair is not two names.
[[nodiscard]] std::vector<Ruling> rulings_of(const RulingOptions& options);

/// Writes the session and prints what was found. Robots that could not be mapped are an error all the same,
/// printed last.
Result<> finish_session(SlamRun run, Job job, OutputDir& out, const std::string& path, bool json);

}  // namespace adit::app

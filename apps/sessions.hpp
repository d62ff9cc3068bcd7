// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What commands share that make a session, from recordings or from earlier sessions.
#pragma once

#include <string>
#include <vector>

#include "adit/io/atomic_file.hpp"
#include "adit/io/georeference.hpp"
#include "adit/slam/session_job.hpp"
#include "adit/slam/slam.hpp"
#include "command_line.hpp"

namespace adit::app {

/// Ends the command where it was given a configuration: a session goes on with its own.
void refuse_configuration(const Common& common);
/// How recordings are read that join a session: as this command says, not as those were that it has. Ends the
/// command where it was given another configuration than `recording.*`.
[[nodiscard]] RecordingConfig reading_of_new(const Common& common, const RecordingConfig& options);

/// Pairs "A,B" of robots.
struct RulingOptions {
  std::vector<std::string> vetoes;
  std::vector<std::string> confirmed;
  std::vector<std::string> withdrawn;

  [[nodiscard]] bool empty() const { return vetoes.empty() && confirmed.empty() && withdrawn.empty(); }
};
/// --veto, --confirm and --withdraw. `needs`: the option that they are given with; "" where they stand alone.
void add_ruling_options(const Command& command, RulingOptions& options, const std::string& needs = "");
/// Wrong usage where a pair is not two names. What is withdrawn comes first.
[[nodiscard]] std::vector<Ruling> rulings_of(const RulingOptions& options);

struct ControlOptions {
  std::string file;
  std::string crs;
};
/// --control and --crs.
Option add_control_options(const Command& command, ControlOptions& options);

/// Control points in one coordinate system.
struct Control {
  std::vector<ControlPoint> points;
  std::string crs;
};
/// Of the file, none where none is given. To be called first, so that what is wrong with it shows before the
/// work.
Result<Control> read_control(const ControlOptions& options);

/// Georeferences the session by these points and keeps the result in it. Notes go to stderr.
Result<std::vector<Georeference>> georeference_session(const std::string& path, const Control& control,
                                                       const std::string& command);
/// What became of each point and how well each map is placed, as text.
void print_georeferences(const std::vector<Georeference>& maps);

/// Writes the session and prints what was found. It is georeferenced by `control`, or by the points that
/// earlier sessions kept. That this failed, or that robots could not be mapped, is an error all the same,
/// printed last.
/// `command` begins its notes.
Result<> finish_session(SlamRun run, Job job, OutputDir& out, const std::string& path, bool json,
                        const Control& control, const std::string& command);

}  // namespace adit::app

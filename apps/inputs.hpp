// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// From what the user names on the command line to recordings.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/io/mount.hpp"
#include "adit/simulation/scenario.hpp"
#include "adit/simulation/world.hpp"
#include "command_line.hpp"

namespace adit::app {

/// The world that routes are driven in. `world_file` overrides the one that the routes name.
Result<World> load_world(const std::filesystem::path& world_file, const std::filesystem::path& routes_file);

/// The options --mount and --points of a command that opens recordings.
void add_recording_options(CLI::App& command, RecordingConfig& config);

/// A recording (see open_recording). What had to be assumed to read it goes to stderr, one line per assumption.
Result<Recording> open_input(const std::string& input, const RecordingConfig& config);

/// Recordings, folders of scans, or one routes.yaml that is simulated on the fly; robots in the order given.
/// Fails on no input, on a routes.yaml among others, and on two robots of one name.
Result<std::vector<Recording>> open_inputs(const std::vector<std::string>& inputs,
                                           const ScenarioConfig& simulation, const RecordingConfig& config);

/// The simulated LiDAR of that name (`--lidar`) put into `config`; its mount stays as it was.
Result<> choose_lidar(const std::string& name, ScenarioConfig& config);

}  // namespace adit::app

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// From what the user names on the command line to recordings.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/io/mount.hpp"
#include "adit/simulation/scenario.hpp"
#include "adit/slam/mapping.hpp"
#include "command_line.hpp"

namespace adit::app {

/// The options --mount, --points, --wheel, --imu, --imu-mount, --tf, --point-times, --point-time-field and
/// --bin-columns of a command that opens recordings.
void add_recording_options(const Command& command, RecordingConfig& config);
/// --truth TOPIC, where --truth is no file.
void add_truth_topic(const Command& command, RecordingConfig& config);

/// A recording (see open_recording). What had to be assumed to read it goes to stderr, one line per
/// assumption.
Result<Recording> open_input(const std::string& input, const RecordingConfig& config);

/// The configuration of recordings, overridden by the options of the command.
[[nodiscard]] RecordingConfig recording_config(RecordingConfig config, const RecordingConfig& options);

/// The recordings to map, and where they come from.
struct Inputs {
  std::vector<Recording> recordings;     ///< In the order given.
  std::string world;                     ///< The mesh that they are simulated in; "" for recordings.
  std::vector<FailedRobot> failed = {};  ///< Robots of a bag that cannot be opened; others of it can.
};

/// Recordings and folders of scans, or one routes.yaml that is simulated on the fly. NAME=INPUT gives the
/// robot of a recording another name; with `recording.namespaces` a bag is one recording of each robot in it,
/// and NAME stands before their names. Fails on an input that cannot be read, of a bag with several robots
/// where none can, and on a routes.yaml among others.
Result<Inputs> open_inputs(const std::vector<std::string>& inputs, const RunConfig& config);

/// NAME and PATH of NAME=PATH; without a name, or where a file of that very name exists, "" and the whole.
std::pair<std::string, std::string> name_and_path(const std::string& input);

/// The simulated LiDARs of these names (`--lidar`) put into `config`; their mount stays as it was.
Result<> choose_lidars(const std::string& names, ScenarioConfig& config);

/// The simulated IMU of that name put into `config`; "none": no IMU.
Result<> choose_imu(const std::string& name, ScenarioConfig& config);

}  // namespace adit::app

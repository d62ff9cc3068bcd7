// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// `recording.toml` beside a folder of clouds: what clouds cannot hold of a recording. People may write it by
/// hand; every key can be left out.
///
///     robot = "robot_0"
///     lidar = "os2-128"
///     mount = "0.3 0 0.9"      # pose of the LiDAR on the robot: x y z [roll pitch yaw], metres, degrees
///     frame = "lidar"          # of the clouds; "base" for clouds that were moved to the robot's frame
///     assumed = ""             # what the program that wrote the folder had to assume, a sentence per line
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "adit/core/config.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// The frame of the clouds in a folder: the LiDAR's, or the robot's.
enum class CloudFrame { lidar, base };
/// "lidar" or "base".
[[nodiscard]] std::string_view to_string(CloudFrame frame);

/// The keys of the file. What it leaves out keeps its default.
struct RecordingToml {
  std::string robot;  ///< "": not said.
  std::string lidar;
  std::string mount;  ///< As in mount.hpp. "": not said.
  CloudFrame frame = CloudFrame::lidar;
  std::string assumed;
};
/// The keys of the file. They point into `file`, which must outlive them.
[[nodiscard]] Fields fields_of(RecordingToml& file);

/// A missing file is not an error: all is left unsaid.
Result<RecordingToml> read_recording_toml(const std::filesystem::path& path);
/// Writes all keys. The file appears whole or not at all.
Result<> write_recording_toml(const std::filesystem::path& path, RecordingToml content);

}  // namespace adit

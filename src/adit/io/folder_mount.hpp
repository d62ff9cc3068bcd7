// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Where the LiDAR stood that measured a folder of clouds. Registration works without it, but the checks of a
/// merge compare which space each scan saw to be free, and that depends on where the sensor was.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/core/result.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/io/recording_toml.hpp"

namespace adit {

/// A mount and how it is known.
struct FolderMount {
  Pose T_base_lidar;       ///< The identity where it is assumed.
  Pose T_lidar_cloud;      ///< From the frame of the files to that of scans.
  std::string source;      ///< See Recording::mount_source.
  std::string assumption;  ///< "" when nothing was assumed.
};

/// Whether the folder has wheel odometry. That is of the base: with it a mount must not be assumed.
enum class Wheels { absent, present };

/// The mount in the order that scan_folder.hpp gives. `clouds` are the files in order; a few of them are
/// read. Fails when they cannot be read, `file.mount` is not a mount, or wheels are there and the mount is
/// unknown.
Result<FolderMount> mount_of_folder(const std::vector<std::filesystem::path>& clouds,
                                    const RecordingToml& file, const std::optional<Pose>& override,
                                    Wheels wheels, const CloudReading& known = {});

}  // namespace adit

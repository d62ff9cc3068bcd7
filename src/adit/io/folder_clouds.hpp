// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// How the clouds of a folder are read: what the first one shows, and what is said of it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/core/point_cloud.hpp"
#include "adit/core/records.hpp"
#include "adit/core/result.hpp"
#include "adit/io/cloud_files.hpp"

namespace adit {

/// The file beside a .bin that has the times of its points (scan_folder.hpp).
[[nodiscard]] std::filesystem::path offsets_beside(const std::filesystem::path& cloud);
/// What that file holds.
[[nodiscard]] std::string offsets_text(const PointCloud& cloud);

/// How the clouds are read, as far as that is `stated` (stated_reading) or shows before any is. Fails as
/// kitti_columns does, check_kitti_columns and check_bin_reading. At least one cloud.
[[nodiscard]] Result<CloudReading> reading_of(const std::vector<std::filesystem::path>& clouds,
                                              const CloudReading& stated);

/// Looks at the first cloud that can be read, says what is assumed of it, and lets all be read so. Fails, as
/// the first of all does, where none can be read, and where the field that is stated for times is not there.
[[nodiscard]] Result<CloudReading> read_as_first(CloudReading known, Recording& recording,
                                                 const std::vector<std::filesystem::path>& clouds,
                                                 bool is_kitti);

/// One of the clouds, with the times beside it.
[[nodiscard]] Result<PointCloud> read_points(const std::filesystem::path& path, const CloudReading& known);

}  // namespace adit

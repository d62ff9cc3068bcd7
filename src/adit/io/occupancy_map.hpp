// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Occupancy grids as ROS loads them: an image and a YAML file that describes it.
#pragma once

#include <filesystem>

#include "adit/core/result.hpp"
#include "adit/geometry/occupancy_grid.hpp"

namespace adit {

/// Writes `path` (.pgm: 0 occupied, 254 free, 205 unknown, north up) and beside it the same name with .yaml,
/// which map servers of ROS 1 and Nav2 take.
Result<> write_occupancy_map(const std::filesystem::path& path, const OccupancyGrid& grid);

}  // namespace adit

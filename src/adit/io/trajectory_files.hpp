// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Trajectories in the format that the ending of the file says.
#pragma once

#include <filesystem>

#include "adit/core/records.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// .csv as `write_trajectory` writes it (a heading is optional), anything else as TUM. KITTI's poses have no
/// stamps: reading a .kitti is an error.
Result<Trajectory> read_trajectory(const std::filesystem::path& path);

/// .csv: a heading, then `stamp_s,x,y,z,qx,qy,qz,qw`; .kitti: KITTI's pose file; anything else TUM. The file
/// appears whole or not at all.
Result<> write_trajectory(const std::filesystem::path& path, const Trajectory& trajectory);

}  // namespace adit

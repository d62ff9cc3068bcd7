// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A folder of clouds as the recording of one robot.
///
/// Scans are all .pcd, .ply or .bin files of the folder (of one kind), ordered by the last number in their
/// names. Stamps come from, in this order:
///  - `stamps.txt`: one decimal stamp in seconds a line, one line a scan;
///  - else the number in the name, as seconds (0017.pcd is stamped 17 s).
/// `odometry.tum` (T_wheelodom_base) and `groundtruth.tum` (T_world_base) are read when they are there; their
/// stamps are of the same clock. The cloud frame is the base frame (T_base_lidar is the identity).
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>

#include "adit/core/records.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// Which scans of the folder to take: first, first + step, first + 2 step ...
struct ScanSelection {
  std::size_t first = 0;
  std::size_t step = 1;
};

/// Errors: no clouds, clouds of several kinds, two scans of one number, a single scan, stamps not ascending
/// or not as many as scans, an odometry that does not cover the scans. Scans themselves are read when asked
/// for.
Result<Recording> read_scan_folder(const std::filesystem::path& folder, ScanSelection selection = {});

/// Writes NNNNNN.pcd (binary), stamps.txt, and odometry.tum and groundtruth.tum where the recording has them.
/// Clouds are written in the base frame. The folder appears whole or not at all; `progress` gets the number
/// of scans written.
Result<> write_scan_folder(const std::filesystem::path& folder, const Recording& recording,
                           const std::function<void(std::size_t)>& progress = {});

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// MCAP files of any length, as a robot with a LiDAR of 131,072 points a scan, wheels and an IMU leaves them.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace adit::bench {

struct MadeBag {
  std::size_t num_scans = 0;
  std::string compression = {};  ///< Of chunks: "" or "zstd".
  bool is_sparse = false;        ///< The points are holes in the file, all zero: length without disk space.
};

/// One chunk a scan, with its checksum (but of holes), indexes and a summary; each scan with 20 samples of an
/// IMU and 5 of wheels. A point is x y z intensity float32 and t uint32: 20 bytes.
void write_made_bag(const std::filesystem::path& path, const MadeBag& bag);

inline constexpr double kMegabytesOfScan = 131072 * 20 / 1e6;

}  // namespace adit::bench

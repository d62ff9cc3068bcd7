// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// OctoMap's binary trees (.bt): A. Hornung et al., "OctoMap: An Efficient Probabilistic 3D Mapping Framework
/// Based on Octrees" (Autonomous Robots 2013).
#pragma once

#include <filesystem>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/result.hpp"
#include "adit/geometry/occupancy_grid.hpp"

namespace adit {

/// How fine the tree is, and which returns count.
struct OctomapConfig {
  double resolution_m = 0.2;  ///< Edge of a cell, metres.
  double reach_m = 20.0;      ///< Metres from the sensor.
};
/// Keys without a prefix. They point into `c`, which must outlive them.
inline Fields fields_of(OctomapConfig& c) {
  return {{"resolution_m", &c.resolution_m, "m", 0.01, 10.0, "edge of a cell of the .bt"},
          {"reach_m", &c.reach_m, "m", 1.0, 300.0, "distance from the sensor up to which a return counts"}};
}

/// Cells are free where scans looked through and occupied where they ended; returns beyond the reach only
/// free the way up to there. World frame. Fails without scans, and where a tree of that resolution (2^16
/// cells along each axis) does not hold the map.
Result<> write_octomap(const std::filesystem::path& path, const std::vector<PlacedScan>& scans,
                       const OctomapConfig& config);

}  // namespace adit

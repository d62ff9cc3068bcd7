// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Where a robot of some height can drive, as a grid seen from above: what stands in its way is occupied,
/// what scans saw past is free. Heights are those above the floor where a robot drove, so that ramps are
/// floor and not walls.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/point_cloud.hpp"
#include "adit/core/pose.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// How fine the grid is and what stands in a robot's way.
struct OccupancyConfig {
  double resolution_m = 0.1;
  double lowest_m = 0.2;
  double highest_m = 1.8;
  double reach_m = 10.0;
};
/// Keys without a prefix. They point into `c`, which must outlive them.
inline Fields fields_of(OccupancyConfig& c) {
  return {{"resolution_m", &c.resolution_m, "m", 0.01, 10.0, "edge of a cell"},
          {"lowest_m", &c.lowest_m, "m", 0.01, 10.0, "what is lower above the floor is driven over"},
          {"highest_m", &c.highest_m, "m", 0.1, 100.0, "what is higher is driven under"},
          {"reach_m", &c.reach_m, "m", 1.0, 100.0,
           "horizontal distance from the sensor up to which a scan counts"}};
}

/// What scans said of a cell. `unknown`: none looked there.
enum class CellState : std::uint8_t { unknown, free, occupied };

/// Row by row from the smallest y, each from the smallest x.
struct OccupancyGrid {
  double resolution_m = 0.0;                         ///< Edge of a cell. Cells begin at multiples of it.
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< Corner of the first cell, world frame, metres.
  std::size_t width = 0;                             ///< Cells along x.
  std::size_t height = 0;                            ///< Cells along y.
  std::vector<CellState> cells;                      ///< width * height of them.

  /// Unknown outside of the grid.
  [[nodiscard]] CellState at(double x, double y) const;
};

/// A scan and where it was taken.
struct PlacedScan {
  std::shared_ptr<const PointCloud> cloud_base;  ///< Base frame: z = 0 on the floor that the robot stands on.
  Vector3 viewpoint = Vector3::Zero();           ///< The sensor, base frame.
  Pose T_world_base;                             ///< Where the robot stood; z of the world is up.
};

/// Each scan is a look around: in every direction of half a degree cells are free up to the nearest obstacle,
/// or as far as floor was seen, and the cells of obstacles are occupied. A point is an obstacle when it lies
/// between `lowest_m` and `highest_m` above the floor of the nearest base of all scans. A cell that was seen
/// free much more often than occupied is free: what was there has moved. Fails without scans, for a band
/// without height, and for more than 400 million cells.
[[nodiscard]] Result<OccupancyGrid> occupancy_of(const std::vector<PlacedScan>& scans,
                                                 const OccupancyConfig& config);

}  // namespace adit

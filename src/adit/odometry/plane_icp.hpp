// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/odometry/scan_to_planes.hpp"
#include "adit/odometry/wheel_guided.hpp"

namespace adit {

struct PlaneIcpConfig {
  ScanToMapConfig scan_to_map{
      .voxel_size = 0.5, .max_points_per_voxel = 10, .max_iterations = 10, .max_correction = 1.0};
  double stationary_motion = kStationaryMotion;
  double sigma = 0.05;
  WheelNoise wheels;
};
[[nodiscard]] Fields fields_of(PlaneIcpConfig& config);

/// adit's own odometry for tunnels. It aligns the scan with the planes of the local map in all six directions
/// and takes the wheels as one more measurement, with a stated noise. In a smooth tube, point-to-point ICP
/// draws the robot towards standing still, because the rings of one scan fit those of the scan before best
/// where they were. Distances from planes do not: there the wheels decide, and the scan decides where the
/// scene has ends, bends or niches. Roll, pitch and height are measured, which wheels alone cannot do
/// (figures: docs/decisions/0011-plane-icp.md).
///
/// A step is `degenerate` where the scan alone leaves a direction open, and enters the map like a good one.
/// Steps that are `too_few_points` or `diverged` keep the wheels' prediction and stay out of the map.
class PlaneIcp {
 public:
  PlaneIcp(const PlaneIcpConfig& config, const Pose& T_base_lidar)
      : config_(config), drive_(config.scan_to_map, config.stationary_motion, T_base_lidar) {}

  /// See the same members of WheelGuided.
  OdometryStep register_scan(const Scan& scan, const WheelDelta& wheel);
  [[nodiscard]] PointCloud cloud_of_last_scan() const { return drive_.cloud_of_last_scan(); }
  [[nodiscard]] const LocalMap& map() const { return drive_.map(); }

 private:
  [[nodiscard]] OdometryStep registered(const ThinnedScan& scan, const Pose& T_prediction,
                                        const Pose& T_last_now);

  PlaneIcpConfig config_;
  WheelGuided drive_;
  double usual_share_ = 0.0;  ///< Share of the last scan's points that lay near a plane of the map.
};

}  // namespace adit

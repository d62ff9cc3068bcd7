// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/odometry/scan_to_planes.hpp"
#include "adit/odometry/wheel_guided.hpp"

namespace adit {

struct PlaneIcpConfig : WheelGuidedConfig {
  double sigma = 0.05;
  WheelNoise wheels;

  PlaneIcpConfig() {
    voxel_size = 0.5;
    max_points_per_voxel = 10;
    max_iterations = 10;
    max_correction = 1.0;
  }
};
Fields fields_of(PlaneIcpConfig& config);

/// adit's own odometry for tunnels: the scan is aligned with the planes of the local map in all six
/// directions, and the wheels are one more measurement, with a stated noise. Point-to-point ICP draws a robot
/// in a smooth tube towards standing still, since the rings of one scan fit those of the last best where they
/// were; distances from planes do not, so that there the wheels decide, and where the scene has ends, bends
/// or niches the scan does. Roll, pitch and height are measured, which wheels alone cannot
/// (docs/decisions/0011-plane-icp.md has the figures).
///
/// A step is `degenerate` where the scan alone leaves a direction open, and enters the map like a good one.
/// `too_few_points` and `diverged` steps are the wheels' word and stay out of the map.
class PlaneIcp {
 public:
  PlaneIcp(const PlaneIcpConfig& config, const Pose& T_base_lidar)
      : config_(config), drive_(config, T_base_lidar) {}

  /// As WheelGuided's, these three.
  OdometryStep register_scan(const Scan& scan, const WheelDelta& wheel);
  [[nodiscard]] PointCloud cloud_of_last_scan() const { return drive_.cloud_of_last_scan(); }
  [[nodiscard]] const LocalMap& map() const { return drive_.map(); }

 private:
  [[nodiscard]] OdometryStep registered(const ThinnedScan& scan, const Pose& T_prediction,
                                        const Pose& T_last_now);

  PlaneIcpConfig config_;
  WheelGuided drive_;
  double usual_share_ = 0.0;  ///< Of a scan's points near a plane of the map.
};

}  // namespace adit

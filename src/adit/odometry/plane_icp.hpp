// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/odometry/local_map.hpp"
#include "adit/odometry/scan_to_planes.hpp"

namespace adit {

struct PlaneIcpConfig : ScanToMapConfig {
  double stationary_motion = 1e-3;
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
  PlaneIcp(const PlaneIcpConfig& config, const Pose& T_base_lidar);

  /// `wheel` is the motion of the base since the last scan; of the first scan it is ignored. Its duration
  /// must be positive where the scan has per-point times.
  OdometryStep register_scan(const Scan& scan, const WheelDelta& wheel);
  /// The last scan, deskewed and range-cropped at full density, in the base frame at its stamp.
  [[nodiscard]] PointCloud cloud_of_last_scan() const { return cloud_; }
  [[nodiscard]] const LocalMap& map() const { return map_; }

 private:
  [[nodiscard]] OdometryStep moving(const Pose& T_prediction, const Pose& T_last_now);

  PlaneIcpConfig config_;
  Pose T_base_lidar_;
  LocalMap map_;
  Pose T_odom_base_;
  std::optional<OdometryStep> last_registered_;  ///< Of the last moving scan, if that entered the map.
  double usual_share_ = 0.0;                     ///< Of a scan's points near a plane of the map.
  bool started_ = false;
  PointCloud cloud_;
  VoxelThinner thinner_;
};

}  // namespace adit

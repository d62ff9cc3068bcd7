// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/odometry/adaptive_threshold.hpp"
#include "adit/odometry/local_map.hpp"
#include "adit/odometry/scan_to_map.hpp"

namespace adit {

struct KinematicIcpConfig : ScanToMapConfig {
  double stationary_motion = 1e-3;

  KinematicIcpConfig() {
    max_iterations = 10;
    convergence = 1e-3;
    max_correction = 1.0;
  }
};

inline Fields fields_of(KinematicIcpConfig& c) {
  Fields fields = fields_of(static_cast<ScanToMapConfig&>(c));
  fields.push_back(
      {"stationary_motion", &c.stationary_motion, "", 0.0, 1.0,
       "norm of the wheel motion [m; rad] since the last registered scan up to which none is registered"});
  return fields;
}

/// Wheel odometry corrected by LiDAR in the two motions that a non-holonomic vehicle has: T. Guadagnino, B.
/// Mersch, I. Vizzo, S. Gupta, M.V.R. Malladi, L. Lobefaro, G. Doisy, C. Stachniss, "Kinematic-ICP: Enhancing
/// LiDAR Odometry with Kinematic Constraints for Wheeled Mobile Robots Moving on Planar Surfaces", ICRA 2025.
///
/// Height, roll and pitch are the wheels'. Where the scene leaves the direction of travel open the residuals
/// hardly move the forward motion, which the regularisation ties to the wheels: such a step is `degenerate`,
/// stands on the wheels in that direction, and enters the map like a good one (else the map would end with
/// the first stretch of smooth tunnel). `too_few_points` and `diverged` steps are the wheels' word and stay
/// out of the map.
class KinematicIcp {
 public:
  KinematicIcp(const KinematicIcpConfig& config, const Pose& T_base_lidar);

  /// `wheel` is the motion of the base since the last scan; of the first scan it is ignored. Its duration
  /// must be positive where the scan has per-point times.
  OdometryStep register_scan(const Scan& scan, const WheelDelta& wheel);
  /// The last scan, deskewed and range-cropped at full density, in the base frame at its stamp.
  [[nodiscard]] PointCloud cloud_of_last_scan() const { return cloud_; }
  [[nodiscard]] const LocalMap& map() const { return map_; }

 private:
  [[nodiscard]] OdometryStep moving(const Pose& T_prediction);
  [[nodiscard]] OdometryStep registered(const ThinnedScan& scan, const Pose& T_prediction);

  KinematicIcpConfig config_;
  Pose T_base_lidar_;
  LocalMap map_;
  DeviationStatistics deviations_;
  Pose T_odom_base_;
  std::optional<OdometryStep> last_registered_;  ///< Of the last moving scan, if that entered the map.
  bool started_ = false;
  PointCloud cloud_;
  VoxelThinner thinner_;
};

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/odometry/adaptive_threshold.hpp"
#include "adit/odometry/wheel_guided.hpp"

namespace adit {

struct KinematicIcpConfig {
  ScanToMapConfig scan_to_map{.max_iterations = 10, .convergence = 1e-3, .max_correction = 1.0};
  double stationary_motion = kStationaryMotion;
};
[[nodiscard]] Fields fields_of(KinematicIcpConfig& config);

/// Wheel odometry corrected by LiDAR in the two motions that a non-holonomic vehicle has: T. Guadagnino, B.
/// Mersch, I. Vizzo, S. Gupta, M.V.R. Malladi, L. Lobefaro, G. Doisy, C. Stachniss, "Kinematic-ICP: Enhancing
/// LiDAR Odometry with Kinematic Constraints for Wheeled Mobile Robots Moving on Planar Surfaces", ICRA 2025.
///
/// Height, roll and pitch are those of the wheels. Where the scene leaves the direction of travel open, the
/// residuals hardly change the forward motion, and the regularisation ties it to the wheels: such a step is
/// `degenerate` and enters the map like a good one (else the map would end with the first stretch of smooth
/// tunnel). Steps that are `too_few_points` or `diverged` keep the wheels' prediction and stay out of the
/// map.
class KinematicIcp {
 public:
  KinematicIcp(const KinematicIcpConfig& config, const Pose& T_base_lidar)
      : config_(config), drive_(config.scan_to_map, config.stationary_motion, T_base_lidar) {}

  /// See the same members of WheelGuided.
  OdometryStep register_scan(const Scan& scan, const WheelDelta& wheel);
  [[nodiscard]] PointCloud cloud_of_last_scan() const { return drive_.cloud_of_last_scan(); }
  [[nodiscard]] const LocalMap& map() const { return drive_.map(); }

 private:
  [[nodiscard]] OdometryStep registered(const ThinnedScan& scan, const Pose& T_prediction);

  KinematicIcpConfig config_;
  WheelGuided drive_;
  DeviationStatistics deviations_;
};

}  // namespace adit

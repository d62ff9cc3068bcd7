// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/odometry/adaptive_threshold.hpp"
#include "adit/odometry/local_map.hpp"
#include "adit/odometry/odometry.hpp"
#include "adit/odometry/scan_to_map.hpp"
#include "adit/odometry/steady_motion.hpp"

namespace adit {

/// Norm of the wheels' motion [m; rad] since the last registered scan up to which the robot counts as at
/// rest; the value of Kinematic-ICP.
inline constexpr double kStationaryMotion = 1e-3;
/// The field stationary_motion, for each configuration that has it.
[[nodiscard]] Field stationary_motion_field(double* stationary_motion);

/// What `KinematicIcp` needs; scan_to_map has defaults of its own here.
struct KinematicIcpConfig {
  ScanToMapConfig scan_to_map{.max_iterations = 10, .convergence = 1e-3, .max_correction = 1.0};
  double stationary_motion = kStationaryMotion;
};
/// Those of scan_to_map, without a prefix, and stationary_motion.
[[nodiscard]] Fields fields_of(KinematicIcpConfig& config);

/// Wheel odometry corrected by LiDAR in the two motions that a non-holonomic vehicle has: T. Guadagnino, B.
/// Mersch, I. Vizzo, S. Gupta, M.V.R. Malladi, L. Lobefaro, G. Doisy, C. Stachniss, "Kinematic-ICP: Enhancing
/// LiDAR Odometry with Kinematic Constraints for Wheeled Mobile Robots Moving on Planar Surfaces", ICRA 2025.
/// The wheels predict and deskew, and a robot at rest is not registered.
///
/// Height, roll and pitch are those of the wheels. Where the scene leaves the direction of travel open, the
/// residuals hardly change the forward motion, and the regularisation ties it to the wheels: such a step is
/// `degenerate` and enters the map like a good one (else the map would end with the first stretch of smooth
/// tunnel). Steps that are `too_few_points` or `diverged` keep the wheels' prediction and stay out of the
/// map.
///
/// Beyond the paper: where the wheels are silent the velocity so far predicts, and no scan counts as one at
/// rest.
class KinematicIcp : public Odometry {
 public:
  /// With an empty map; T_odom_base starts at identity. Ranges of the settings are not checked.
  KinematicIcp(const KinematicIcpConfig& config, const Pose& T_base_lidar);

  /// The duration of the wheels' motion must be positive where the scan has per-point times.
  OdometryStep register_scan(const Scan& scan, const SensedMotion& motion) override;
  [[nodiscard]] const PointCloud& cloud_of_last_scan() const override { return cloud_; }
  /// In the frame odom; empty before the first scan.
  [[nodiscard]] const LocalMap& map() const { return map_; }

 private:
  [[nodiscard]] bool is_at_rest(const Pose& T_prediction) const;
  [[nodiscard]] OdometryStep resting(const Pose& T_prediction) const;
  [[nodiscard]] OdometryStep moving(const Pose& T_prediction, bool by_wheels);
  [[nodiscard]] OdometryStep registered(const ThinnedScan& scan, const Pose& T_prediction, bool by_wheels);

  KinematicIcpConfig config_;
  Pose T_base_lidar_;
  LocalMap map_;
  SteadyMotion motion_;
  DeviationStatistics deviations_;
  std::optional<OdometryStep> last_registered_;  ///< Of the last moving scan, if that entered the map.
  PointCloud cloud_;
  VoxelThinner thinner_;
};

}  // namespace adit

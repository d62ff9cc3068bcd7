// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/odometry/local_map.hpp"
#include "adit/odometry/scan_to_map.hpp"

namespace adit {

/// Norm of the wheels' motion [m; rad] since the last registered scan up to which the robot counts as at
/// rest; the value of Kinematic-ICP (Guadagnino et al., ICRA 2025).
inline constexpr double kStationaryMotion = 1e-3;
[[nodiscard]] Field stationary_motion_field(double* stationary_motion);

/// What odometries with wheels share, however they register a scan: the wheels predict and deskew, a robot at
/// rest is not registered, the first scan starts the map, and scans that were registered enter it.
class WheelGuided {
 public:
  /// Registers a thinned scan with the map, which is not empty. `T_prediction`: T_odom_base by the wheels,
  /// after their motion `T_last_now` (T_base0_base1) since the last scan.
  using Register =
      std::function<OdometryStep(const ThinnedScan& scan, const Pose& T_prediction, const Pose& T_last_now)>;

  WheelGuided(const ScanToMapConfig& config, double stationary_motion, const Pose& T_base_lidar);

  /// `wheel` is the motion of the base since the last scan; it is ignored for the first scan. Its duration
  /// must be positive where the scan has per-point times.
  OdometryStep register_scan(const Scan& scan, const WheelDelta& wheel, const Register& register_with_map);
  /// The last scan, deskewed and range-cropped at full density, in the base frame at its stamp.
  [[nodiscard]] const PointCloud& cloud_of_last_scan() const { return cloud_; }
  [[nodiscard]] const LocalMap& map() const { return map_; }

 private:
  [[nodiscard]] bool is_at_rest(const Pose& T_prediction) const;
  [[nodiscard]] OdometryStep resting(const Pose& T_prediction) const;
  [[nodiscard]] OdometryStep moving(const Pose& T_prediction, const Pose& T_last_now,
                                    const Register& register_with_map);

  ScanToMapConfig config_;
  double stationary_motion_;
  Pose T_base_lidar_;
  LocalMap map_;
  Pose T_odom_base_;
  std::optional<OdometryStep> last_registered_;  ///< Of the last moving scan, if that entered the map.
  bool started_ = false;
  PointCloud cloud_;
  VoxelThinner thinner_;
};

}  // namespace adit

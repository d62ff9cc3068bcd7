// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/kinematic_icp.hpp"

#include <cmath>

namespace adit {

OdometryStep KinematicIcp::register_scan(const Scan& scan, const WheelDelta& wheel) {
  return drive_.register_scan(
      scan, wheel, [&](const ThinnedScan& thin, const Pose& T_prediction, const Pose& /*T_last_now*/) {
        return registered(thin, T_prediction);
      });
}

OdometryStep KinematicIcp::registered(const ThinnedScan& scan, const Pose& T_prediction) {
  // Section III-C: what the spacing of the map and what the wheels leave open.
  const double sigma_map = config_.voxel_size / std::sqrt(config_.max_points_per_voxel);
  const double max_distance = 3.0 * (sigma_map + deviations_.sigma());
  const Alignment alignment = align_unicycle(scan.source, map(), T_prediction, max_distance, config_);
  if (alignment.status == StepStatus::ok)
    deviations_.add(point_deviation(T_prediction.inverse() * alignment.T_map_base, config_.max_range));
  return step_of(alignment, scan.source, map(), max_distance, config_);
}

}  // namespace adit

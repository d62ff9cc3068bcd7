// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/kinematic_icp.hpp"

#include <cmath>

namespace adit {

Fields fields_of(KinematicIcpConfig& c) {
  Fields fields = fields_of(c.scan_to_map);
  fields.push_back(stationary_motion_field(&c.stationary_motion));
  return fields;
}

OdometryStep KinematicIcp::register_scan(const Scan& scan, const WheelDelta& wheel) {
  return drive_.register_scan(
      scan, wheel, [&](const ThinnedScan& thin, const Pose& T_prediction, const Pose& /*T_last_now*/) {
        return registered(thin, T_prediction);
      });
}

OdometryStep KinematicIcp::registered(const ThinnedScan& scan, const Pose& T_prediction) {
  // Section III-C: uncertainty from the spacing of the map's points and from the wheels.
  const ScanToMapConfig& config = config_.scan_to_map;
  const double sigma_map = config.voxel_size / std::sqrt(config.max_points_per_voxel);
  const double max_distance = 3.0 * (sigma_map + deviations_.sigma());
  const Alignment alignment = align_unicycle(scan.source, map(), T_prediction, max_distance, config);
  if (alignment.status == StepStatus::ok)
    deviations_.add(point_deviation(T_prediction.inverse() * alignment.T_map_base, config.max_range));
  return step_of(alignment, scan.source, map(), max_distance, config);
}

}  // namespace adit

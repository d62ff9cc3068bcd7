// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/plane_icp.hpp"

namespace adit {

Fields fields_of(PlaneIcpConfig& c) {
  Fields fields = fields_of(c.scan_to_map);
  fields.push_back(stationary_motion_field(&c.stationary_motion));
  fields.push_back(
      {"sigma", &c.sigma, "m", 1e-3, 1.0, "standard deviation of a point's distance from its plane"});
  append(fields, "wheels", fields_of(c.wheels));
  return fields;
}

OdometryStep PlaneIcp::register_scan(const Scan& scan, const WheelDelta& wheel) {
  return drive_.register_scan(scan, wheel,
                              [&](const ThinnedScan& thin, const Pose& T_prediction, const Pose& T_last_now) {
                                return registered(thin, T_prediction, T_last_now);
                              });
}

OdometryStep PlaneIcp::registered(const ThinnedScan& scan, const Pose& T_prediction, const Pose& T_last_now) {
  OdometryStep step = first_step(scan, T_prediction, config_.scan_to_map);
  if (step.status == StepStatus::too_few_points) return step;
  const PlaneAlignment alignment =
      align_point_to_plane(scan.source, map(),
                           {.T_map_base = T_prediction,
                            .information = wheel_information(config_.wheels, T_last_now),
                            .usual_share = usual_share_},
                           config_.sigma, config_.scan_to_map);
  usual_share_ = alignment.share_near;
  step.T_odom_base = alignment.T_map_base;
  step.status = alignment.status == StepStatus::ok && alignment.seen.degenerate ? StepStatus::degenerate
                                                                                : alignment.status;
  step.information = alignment.seen.information;
  step.num_correspondences = alignment.num_correspondences;
  step.iterations = alignment.iterations;
  return step;
}

}  // namespace adit

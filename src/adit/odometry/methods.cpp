// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/methods.hpp"

#include <utility>

#include "adit/core/check.hpp"
#include "adit/odometry/levelled_odometry.hpp"

namespace adit {
std::string_view to_string(OdometryMethod method) {
  switch (method) {
    case OdometryMethod::plane_icp:
      return "plane-icp";
    case OdometryMethod::kinematic_icp:
      return "kinematic-icp";
    case OdometryMethod::kiss_icp:
      return "kiss-icp";
  }
  return "unknown";
}

Fields fields_of(OdometryConfig& c) {
  Fields fields = {enum_field("method", &c.method, kOdometryMethods,
                              "LiDAR and wheels, as adit does it or as the paper does; or LiDAR alone")};
  append(fields, "kiss_icp", fields_of(c.kiss_icp));
  append(fields, "kinematic_icp", fields_of(c.kinematic_icp));
  append(fields, "plane_icp", fields_of(c.plane_icp));
  return fields;
}

std::unique_ptr<Odometry> make_odometry(const OdometryConfig& config, const Pose& T_base_lidar) {
  OdometryConfig checked = config;
  const auto valid = check_fields(fields_of(checked));
  if (!valid) throw ContractViolation(valid.error().message);
  switch (config.method) {
    case OdometryMethod::kiss_icp:
      return std::make_unique<KissIcp>(config.kiss_icp, T_base_lidar);
    case OdometryMethod::kinematic_icp:
      return std::make_unique<KinematicIcp>(config.kinematic_icp, T_base_lidar);
    case OdometryMethod::plane_icp:
      break;
  }
  auto plane_icp = std::make_unique<PlaneIcp>(config.plane_icp, T_base_lidar);
  if (config.plane_icp.tilt.drift_deg == 0.0) return plane_icp;
  return std::make_unique<LevelledOdometry>(std::move(plane_icp), config.plane_icp.tilt);
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/odometry.hpp"

#include "adit/core/check.hpp"

namespace adit {
namespace {

std::variant<KissIcp, KinematicIcp, PlaneIcp> method_of(OdometryConfig config, const Pose& T_base_lidar) {
  const auto valid = check_fields(fields_of(config));
  if (!valid) throw ContractViolation(valid.error().message);
  switch (config.method) {
    case OdometryMethod::kiss_icp:
      return KissIcp(config.kiss_icp, T_base_lidar);
    case OdometryMethod::kinematic_icp:
      return KinematicIcp(config.kinematic_icp, T_base_lidar);
    case OdometryMethod::plane_icp:
      break;
  }
  return PlaneIcp(config.plane_icp, T_base_lidar);
}

}  // namespace

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

Odometry::Odometry(const OdometryConfig& config, const Pose& T_base_lidar)
    : method_(method_of(config, T_base_lidar)) {}

OdometryStep Odometry::register_scan(const Scan& scan, const std::optional<WheelDelta>& wheel) {
  const bool first = !started_;
  started_ = true;
  if (auto* kiss_icp = std::get_if<KissIcp>(&method_)) return kiss_icp->register_scan(scan);
  ADIT_CHECK(first || wheel, "this odometry needs the wheels' motion since the last scan");
  const WheelDelta motion = wheel.value_or(WheelDelta{});
  if (auto* kinematic_icp = std::get_if<KinematicIcp>(&method_))
    return kinematic_icp->register_scan(scan, motion);
  return std::get<PlaneIcp>(method_).register_scan(scan, motion);
}

PointCloud Odometry::cloud_of_last_scan() const {
  return std::visit([](const auto& method) { return method.cloud_of_last_scan(); }, method_);
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/odometry.hpp"

#include "adit/core/check.hpp"

namespace adit {
namespace {

std::variant<KissIcp, KinematicIcp, PlaneIcp> method_of(OdometryConfig config, const Pose& T_base_lidar) {
  const auto valid = check_fields(fields_of(config));
  if (!valid) throw ContractViolation(valid.error().message);
  if (config.method == "kiss-icp") return KissIcp(config.kiss_icp, T_base_lidar);
  if (config.method == "kinematic-icp") return KinematicIcp(config.kinematic_icp, T_base_lidar);
  return PlaneIcp(config.plane_icp, T_base_lidar);
}

}  // namespace

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

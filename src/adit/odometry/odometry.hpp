// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <variant>

#include "adit/odometry/kinematic_icp.hpp"
#include "adit/odometry/kiss_icp.hpp"
#include "adit/odometry/plane_icp.hpp"

namespace adit {

struct OdometryConfig {
  std::string method = "plane-icp";
  KissIcpConfig kiss_icp;
  KinematicIcpConfig kinematic_icp;
  PlaneIcpConfig plane_icp;

  [[nodiscard]] bool needs_wheels() const { return method != "kiss-icp"; }
};

inline Fields fields_of(OdometryConfig& c) {
  Fields fields = {{"method",
                    &c.method,
                    "",
                    0,
                    0,
                    "LiDAR and wheels, as adit does it or as the paper does; or LiDAR alone",
                    {"plane-icp", "kinematic-icp", "kiss-icp"}}};
  append(fields, "kiss_icp", fields_of(c.kiss_icp));
  append(fields, "kinematic_icp", fields_of(c.kinematic_icp));
  append(fields, "plane_icp", fields_of(c.plane_icp));
  return fields;
}

/// The odometry that the configuration names.
class Odometry {
 public:
  /// Throws ContractViolation when the configuration is outside its ranges or names no known method.
  Odometry(const OdometryConfig& config, const Pose& T_base_lidar);

  /// `wheel`: motion of the base since the last scan. KISS-ICP does not look at it; the others
  /// throw ContractViolation without it, the first scan excepted.
  OdometryStep register_scan(const Scan& scan, const std::optional<WheelDelta>& wheel);
  /// The last scan, deskewed and range-cropped at full density, in the base frame at its stamp.
  [[nodiscard]] PointCloud cloud_of_last_scan() const;

 private:
  std::variant<KissIcp, KinematicIcp, PlaneIcp> method_;
  bool started_ = false;
};

}  // namespace adit

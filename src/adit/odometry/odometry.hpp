// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <variant>

#include "adit/odometry/kinematic_icp.hpp"
#include "adit/odometry/kiss_icp.hpp"
#include "adit/odometry/plane_icp.hpp"

namespace adit {

enum class OdometryMethod { plane_icp, kinematic_icp, kiss_icp };
inline constexpr std::array kOdometryMethods{OdometryMethod::plane_icp, OdometryMethod::kinematic_icp,
                                             OdometryMethod::kiss_icp};
/// "plane-icp", "kinematic-icp", "kiss-icp".
[[nodiscard]] std::string_view to_string(OdometryMethod method);

struct OdometryConfig {
  OdometryMethod method = OdometryMethod::plane_icp;
  KissIcpConfig kiss_icp;
  KinematicIcpConfig kinematic_icp;
  PlaneIcpConfig plane_icp;

  [[nodiscard]] bool needs_wheels() const { return method != OdometryMethod::kiss_icp; }
};
[[nodiscard]] Fields fields_of(OdometryConfig& config);

/// The odometry that the configuration names.
class Odometry {
 public:
  /// Throws ContractViolation when the configuration is outside its ranges.
  Odometry(const OdometryConfig& config, const Pose& T_base_lidar);

  /// `wheel`: motion of the base since the last scan. KISS-ICP ignores it; the other methods throw
  /// ContractViolation without it, the first scan excepted.
  OdometryStep register_scan(const Scan& scan, const std::optional<WheelDelta>& wheel);
  /// The last scan, deskewed and range-cropped at full density, in the base frame at its stamp.
  [[nodiscard]] PointCloud cloud_of_last_scan() const;

 private:
  std::variant<KissIcp, KinematicIcp, PlaneIcp> method_;
  bool started_ = false;
};

}  // namespace adit

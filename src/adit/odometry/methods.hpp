// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <memory>
#include <string_view>

#include "adit/odometry/kinematic_icp.hpp"
#include "adit/odometry/kiss_icp.hpp"
#include "adit/odometry/plane_icp.hpp"

namespace adit {

/// What adit brings.
enum class OdometryMethod { plane_icp, kinematic_icp, kiss_icp };
/// All of them.
inline constexpr std::array kOdometryMethods{OdometryMethod::plane_icp, OdometryMethod::kinematic_icp,
                                             OdometryMethod::kiss_icp};
/// "plane-icp", "kinematic-icp", "kiss-icp".
[[nodiscard]] std::string_view to_string(OdometryMethod method);

/// A method, and the settings of each.
struct OdometryConfig {
  OdometryMethod method = OdometryMethod::plane_icp;  ///< Which one runs.
  KissIcpConfig kiss_icp;                             ///< Of kiss-icp.
  KinematicIcpConfig kinematic_icp;                   ///< Of kinematic-icp.
  PlaneIcpConfig plane_icp;                           ///< Of plane-icp.

  /// Whether the method refuses recordings without wheels.
  [[nodiscard]] bool needs_wheels() const { return method == OdometryMethod::kinematic_icp; }
};
/// method, kiss_icp.*, kinematic_icp.*, plane_icp.*.
[[nodiscard]] Fields fields_of(OdometryConfig& config);

/// The odometry that the configuration names. Throws ContractViolation when the configuration is outside its
/// ranges.
[[nodiscard]] std::unique_ptr<Odometry> make_odometry(const OdometryConfig& config, const Pose& T_base_lidar);

}  // namespace adit

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

  [[nodiscard]] bool needs_wheels() const { return method == OdometryMethod::kinematic_icp; }
};
[[nodiscard]] Fields fields_of(OdometryConfig& config);

/// The odometry that the configuration names. Throws ContractViolation when the configuration is outside its
/// ranges.
[[nodiscard]] std::unique_ptr<Odometry> make_odometry(const OdometryConfig& config, const Pose& T_base_lidar);

}  // namespace adit

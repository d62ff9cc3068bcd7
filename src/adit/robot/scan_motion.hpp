// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// How the robot moved during a short stretch of scans, by the scans alone, to check other sensors against.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "adit/core/records.hpp"

namespace adit {

/// The first scans of a stretch, until the odometry knows how fast the robot is.
inline constexpr std::size_t kSettlingScans = 4;

/// Scans that checks go by: about ten per second.
[[nodiscard]] std::vector<std::size_t> scans_to_check(const Recording& recording);

/// A stretch of scans, registered.
struct ScanMotion {
  std::vector<OdometryStep> steps;  ///< One per scan, T_odom_base; empty for fewer than two scans.
  bool has_times = true;            ///< The clouds have times of their points.
};

/// Registers these scans one after the other, without wheels and IMU. A scan that cannot be read ends the
/// stretch: whoever makes the map says so.
[[nodiscard]] ScanMotion motion_of_scans(const Recording& recording, std::span<const std::size_t> scans);

/// `num` of the numbers 0 to num_all - 1, or all, spread evenly and ascending.
[[nodiscard]] std::vector<std::size_t> spread_over(std::size_t num_all, std::size_t num);

}  // namespace adit

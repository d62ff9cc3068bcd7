// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "adit/core/check.hpp"
#include "adit/core/pose.hpp"

namespace adit {

/// Points in metres. The owner says in which frame. `intensities` and `time_offsets_ns` are each empty or as
/// long as `points`. A time offset is the point's own time minus the stamp of the scan that holds the cloud.
struct PointCloud {
  std::vector<Eigen::Vector3f> points;        ///< Metres.
  std::vector<float> intensities;             ///< In the unit of the sensor.
  std::vector<std::int32_t> time_offsets_ns;  ///< Nanoseconds from the scan's stamp.

  /// The number of points.
  [[nodiscard]] std::size_t size() const { return points.size(); }
  /// Whether there is no point.
  [[nodiscard]] bool empty() const { return points.empty(); }
  /// Whether points have times of their own.
  [[nodiscard]] bool has_times() const { return !time_offsets_ns.empty(); }
  /// Throws ContractViolation where the arrays differ in length.
  void check() const {
    ADIT_CHECK(intensities.empty() || intensities.size() == points.size(),
               "one intensity per point, or none at all");
    ADIT_CHECK(time_offsets_ns.empty() || time_offsets_ns.size() == points.size(),
               "one time per point, or none at all");
  }
};

/// The same points seen from frame a: p_a = T_a_b * p_b. Intensities and times are kept.
[[nodiscard]] PointCloud transformed(const Pose& T_a_b, PointCloud cloud_b);

/// Adds the points and intensities of `part`; where only one of both has intensities, the other's are 0.
/// Times are dropped. `part` is another cloud.
void append(PointCloud& cloud, const PointCloud& part);

}  // namespace adit

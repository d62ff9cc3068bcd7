// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Removing the motion of the sensor within one sweep, under constant velocity (Vizzo et al., "KISS-ICP",
/// RA-L 2023, section III-A).
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "adit/core/point_cloud.hpp"
#include "adit/core/pose.hpp"
#include "adit/core/time.hpp"

namespace adit {

/// A body that moved by T_start_end within `duration` (positive) and moves on with the same twist.
struct ConstantVelocity {
  Pose T_start_end;
  Duration duration{};

  /// The body at `offset` from a moment, seen from the body at that moment: exp(offset / duration *
  /// log(T_start_end)).
  [[nodiscard]] Pose pose_after(Duration offset) const;
};

/// p_body_at_stamp = SweepTransform(offset) * p_sensor_at_offset, for the many points of one sweep. The pose
/// is exact at 65 knots over the span of offsets and its matrix linear between them: for a turn of 0.3 rad
/// within the sweep the error is 3e-6 of the range (0.3 mm at 100 m), far below any sensor's noise.
class SweepTransform {
 public:
  /// `offsets_ns` (non-empty) are the points' times less the stamp, as in PointCloud.
  SweepTransform(const ConstantVelocity& motion, const Pose& T_body_sensor,
                 std::span<const std::int32_t> offsets_ns);

  [[nodiscard]] Eigen::Vector3f apply(std::int32_t offset_ns, const Eigen::Vector3f& p_sensor) const {
    const float s = static_cast<float>(offset_ns - first_ns_) * knots_per_ns_;
    const Knot& knot = knots_[static_cast<std::size_t>(s)];
    const Matrix34 T = knot.value + (s - std::floor(s)) * knot.slope;
    return T.leftCols<3>() * p_sensor + T.col(3);
  }

 private:
  using Matrix34 = Eigen::Matrix<float, 3, 4>;
  struct Knot {
    Matrix34 value;
    Matrix34 slope;
  };
  std::vector<Knot> knots_;
  std::int64_t first_ns_ = 0;
  float knots_per_ns_ = 0.0F;
};

/// The cloud as if all of it had been measured at the scan's stamp: each point moved from where the sensor
/// was at the point's own time. `motion` is the sensor's. The result holds no times any more, since none is
/// left to remove; a cloud without times (`has_times()` is false: nothing is known about when its points were
/// taken) comes back unchanged.
[[nodiscard]] PointCloud deskewed(PointCloud cloud, const ConstantVelocity& motion);

}  // namespace adit

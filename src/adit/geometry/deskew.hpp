// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Removing the motion of the sensor within one sweep, under constant velocity (Vizzo et al., "KISS-ICP",
/// RA-L 2023, section III-A).
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "adit/core/point_cloud.hpp"
#include "adit/core/pose.hpp"
#include "adit/core/time.hpp"

namespace adit {

/// A body that moved by T_start_end within `duration` (positive) and moves on with the same twist.
struct ConstantVelocity {
  Pose T_start_end;     ///< The body at the end in the body at the start.
  Duration duration{};  ///< From start to end.

  /// The pose of the body `offset` after a moment, in the body's frame at that moment: exp(offset / duration
  /// * log(T_start_end)).
  [[nodiscard]] Pose pose_after(Duration offset) const;
};

/// How a body moved during a sweep.
struct SweepMotion {
  /// Its pose `offset` after a moment, in its frame at that moment.
  std::function<Pose(Duration)> pose_after;
  double knots_per_second = 0.0;  ///< So often at least its motion is looked at.
};
/// Its `pose_after` throws ContractViolation where the duration is not positive.
[[nodiscard]] SweepMotion sweep_of(const ConstantVelocity& motion);

/// p_body_at_stamp = SweepTransform(offset) * p_sensor_at_offset, for the many points of one sweep. The pose
/// is exact at knots over the span of offsets, and its matrix is linear between them. There are enough knots
/// for an error of at most 3e-6 of the range (0.3 mm at 100 m), far below the noise of any sensor.
class SweepTransform {
 public:
  /// The first three rows of a pose's matrix: [R, t].
  using Matrix34 = Eigen::Matrix<float, 3, 4>;
  /// The transform at one moment of the sweep.
  struct Knot {
    Matrix34 value;  ///< T_body_sensor: from the sensor at that moment to the body at the stamp.
    Matrix34 slope;  ///< Change to the next knot.
  };

  /// `offsets_ns` (non-empty) are the points' times less the stamp, as in PointCloud.
  SweepTransform(const SweepMotion& motion, const Pose& T_body_sensor,
                 std::span<const std::int32_t> offsets_ns);

  /// Spans of equal length that do not overlap; offsets are among those given to the constructor. Fast where
  /// points that follow one another were measured one after the other.
  void apply(std::span<const std::int32_t> offsets_ns, std::span<const Eigen::Vector3f> p_sensor,
             std::span<Eigen::Vector3f> p_body) const;

 private:
  std::vector<Knot> knots_;
  std::int32_t first_ns_ = 0;
  float knots_per_step_ = 0.0F;  ///< Steps of 2 ns: the span of offsets then fits an int.
};

/// p_a = T * p_b for each point, T = [R, t]; spans of equal length that do not overlap.
void transform_points(const SweepTransform::Matrix34& T_a_b, std::span<const Eigen::Vector3f> p_b,
                      std::span<Eigen::Vector3f> p_a);

/// The cloud as if all of it had been measured at the scan's stamp: each point moved from where the sensor
/// was at the point's own time. `motion` is the sensor's. The result holds no times; a cloud without times
/// comes back unchanged, since it is not known when its points were measured.
[[nodiscard]] PointCloud deskewed(PointCloud cloud, const ConstantVelocity& motion);

}  // namespace adit

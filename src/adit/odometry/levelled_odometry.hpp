// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <deque>
#include <memory>
#include <optional>

#include "adit/odometry/odometry.hpp"
#include "adit/odometry/tilt_filter.hpp"

namespace adit {

/// An odometry whose roll and pitch follow gravity, where there is an IMU; without one, what it wraps, bit
/// for bit. Ranges that are longer or shorter by a little at the roof than at the floor bend a map, by
/// degrees over some hundred metres. Over a metre and more the mean of the specific force, less what the
/// odometry says of the acceleration, points up; a `TiltFilter` finds by it what roll and pitch have drifted
/// by, and the path goes on from where it is without that. What was driven before stays as it was. Nothing is
/// measured where scans were not registered: there the acceleration would be the IMU's own. Figures:
/// docs/decisions/0090-gravity-keeps-a-map-level.md.
class LevelledOdometry : public Odometry {
 public:
  /// Takes what is to be levelled, at its first scan.
  LevelledOdometry(std::unique_ptr<Odometry> odometry, const TiltNoise& noise);

  OdometryStep register_scan(const Scan& scan, const SensedMotion& motion) override;
  [[nodiscard]] const PointCloud& cloud_of_last_scan() const override {
    return odometry_->cloud_of_last_scan();
  }

 private:
  /// At a scan; integrals over time since some moment. In the frame of what is wrapped.
  struct Moment {
    Stamp stamp;
    Vector3 imu = Vector3::Zero();       ///< Where the IMU is, metres.
    Vector3 force = Vector3::Zero();     ///< Integral of the specific force.
    Matrix3 rotation = Matrix3::Zero();  ///< Integral of the body's rotation.
    double driven_m = 0.0;               ///< Since the start.
  };
  /// Where a stretch that is measured begins or ends.
  struct End {
    Moment at;
    Vector3 velocity = Vector3::Zero();  ///< Of the IMU.
  };

  /// Whether there are enough moments to know a velocity.
  [[nodiscard]] bool add_moment(const OdometryStep& step, const SensedMotion& motion);
  void measure_up();

  std::unique_ptr<Odometry> odometry_;
  TiltFilter tilt_;
  std::optional<Pose> T_odom_drifted_;  ///< From the frame of what is wrapped; none before it is known.
  std::optional<StampedPose> last_;     ///< In the frame of what is wrapped.
  std::deque<Moment> moments_;          ///< At the last scans, all registered and with an IMU.
  std::optional<End> begin_;            ///< Of the stretch that is measured.
  bool has_map_ = false;                ///< A scan was aligned with one.
  double driven_m_ = 0.0;
  double driven_before_m_ = 0.0;  ///< When the filter measured last.
};

}  // namespace adit

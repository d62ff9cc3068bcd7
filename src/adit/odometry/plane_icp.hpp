// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/odometry/kinematic_icp.hpp"
#include "adit/odometry/motion_filter.hpp"
#include "adit/odometry/odometry.hpp"
#include "adit/odometry/scan_to_planes.hpp"
#include "adit/odometry/tilt_filter.hpp"
#include "adit/odometry/wheel_trust.hpp"

namespace adit {

/// What `PlaneIcp` needs; scan_to_map has defaults of its own here.
struct PlaneIcpConfig {
  ScanToMapConfig scan_to_map{.voxel_size = 0.5,
                              .max_points_per_voxel = 10,
                              .max_iterations = 10,
                              .max_correction = 1.0,
                              .max_turn_deg = 15.0};
  double stationary_motion = kStationaryMotion;
  double sigma = 0.05;
  WheelNoise wheels;
  MotionNoise motion;
  ImuNoise imu;
  TiltNoise tilt;  ///< Of `LevelledOdometry`, by which `make_odometry` follows gravity.
};
/// Those of scan_to_map, without a prefix, and stationary_motion, sigma, wheels.*, motion.*, imu.*, tilt.*.
[[nodiscard]] Fields fields_of(PlaneIcpConfig& config);

/// adit's own odometry for tunnels. A filter predicts the motion since the last registered scan, by the IMU
/// and the wheels where they measured it and by the velocity so far, with a covariance; the scan is aligned
/// with the planes of the local map in all six directions, and the prediction counts as one more measurement.
/// In a smooth tube, point-to-point ICP draws the robot towards standing still, because the rings of one scan
/// fit those of the scan before best where they were. Distances from planes do not: there the prediction
/// decides, and the scan decides where the scene has ends, bends or niches. Roll, pitch and height are
/// measured, which wheels alone cannot do (figures: docs/decisions/0011-plane-icp.md).
///
/// A step is `degenerate` where the scan alone leaves a direction open, and enters the map like a good one.
/// Steps that are `too_few_points` or `diverged` keep the prediction and stay out of the map. A young map has
/// few planes: its first five scans are `no_map` where they match none, and enter it as predicted. Where ten
/// scans in a row with points enough match nothing, the robot is not where its map is (it was carried, its
/// wheels spun): the tenth starts a new map at the prediction.
///
/// Wheels whose count differs from what was driven (they spin, or the robot is carried) are left out until
/// both agree again; a step says how many metres they counted in vain. A robot whose wheels stand is
/// at rest, unless its IMU feels that it moves.
class PlaneIcp : public Odometry {
 public:
  /// With an empty map. Ranges of the settings are not checked.
  PlaneIcp(const PlaneIcpConfig& config, const Pose& T_base_lidar);

  OdometryStep register_scan(const Scan& scan, const SensedMotion& motion) override;
  [[nodiscard]] const PointCloud& cloud_of_last_scan() const override { return cloud_; }
  /// In the frame odom; empty before the first scan.
  [[nodiscard]] const LocalMap& map() const { return map_; }
  /// As the last scan has left it.
  [[nodiscard]] const MotionFilter& filter() const { return filter_; }

 private:
  void level(const SensedMotion& motion);
  [[nodiscard]] bool is_at_rest(const SensedMotion& motion) const;
  void judge_wheels(const SensedMotion& motion, OdometryStep& step);
  [[nodiscard]] OdometryStep resting(const Pose& T_last_now);
  [[nodiscard]] OdometryStep moving(const MotionPrior& prior);
  [[nodiscard]] OdometryStep registered(const ThinnedScan& scan, const PosePrior& prior);
  void remember(const OdometryStep& step, const ThinnedScan& scan);

  PlaneIcpConfig config_;
  Pose T_base_lidar_;
  LocalMap map_;
  MotionFilter filter_;
  std::optional<Stamp> stamp_;            ///< Of the last scan.
  OdometryStep reference_;                ///< Of the last scan that entered the map; at first the start.
  std::optional<Pose> T_ref_wheels_;      ///< By the wheels since then; none after a silence.
  Matrix6 covariance_ = Matrix6::Zero();  ///< Of the pose registered last, in the frame of the reference.
  Matrix6 onto_fixed_ = Matrix6::Zero();  ///< Projection onto the directions that it fixed.
  WheelTrust wheels_;
  Pose T_odom_last_;          ///< Of the last scan, whatever became of it.
  double usual_share_ = 0.0;  ///< Share of the points of the last registered scan that lay near a plane.
  int num_missed_ = 0;        ///< Scans since the reference.
  int num_unmatched_ = 0;     ///< Of those, the ones in a row that had points enough.
  int num_in_map_ = 0;        ///< Scans that the map has taken.
  PointCloud cloud_;
  VoxelThinner thinner_;
};

}  // namespace adit

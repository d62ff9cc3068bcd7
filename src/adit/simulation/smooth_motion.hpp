// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A twice differentiable motion through the poses of a trajectory, for sensors that measure derivatives.
///
/// Uniform cubic B-splines: of the position, and the cumulative one of the rotation (C. Sommer, V. Usenko,
/// D. Schubert, N. Demmel, D. Cremers, "Efficient derivative computation for cumulative B-splines on Lie
/// groups", CVPR 2020, sections 3 and 4). Their control points are the poses, 25 per second, each moved
/// against the bend of its neighbours, so that the spline passes within a tenth of a millimetre of a robot's
/// trajectory.
#pragma once

#include <vector>

#include "adit/core/records.hpp"

namespace adit {

/// Where a body is and how it moves at one moment. Of SmoothMotion the body is the sensor.
struct Kinematics {
  Pose T_world_body;         ///< Its rotation turns angular_velocity into the world frame.
  Vector3 velocity;          ///< World frame, metres per second.
  Vector3 acceleration;      ///< World frame, metres per second squared.
  Vector3 angular_velocity;  ///< Body frame, radians per second.
};

/// The splines of one sensor on one drive. The trajectory need not outlive them.
class SmoothMotion {
 public:
  /// The motion of a sensor at T_body_sensor on the body that follows `trajectory` (two poses or more).
  SmoothMotion(const Trajectory& trajectory, const Pose& T_body_sensor);

  /// Beyond the ends of the trajectory, the motion at its ends.
  [[nodiscard]] Kinematics at(Stamp stamp) const;

 private:
  Stamp begin_;
  double seconds_per_segment_;
  std::vector<Vector3> positions_;  // control points, one more at each end
  std::vector<Eigen::Quaterniond> rotations_;
};

}  // namespace adit

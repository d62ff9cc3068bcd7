// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/factors.hpp"

namespace adit {
namespace {

// d/dtheta of R(theta)^T v, for v seen in the turned frame.
Eigen::Vector2d clockwise(const Eigen::Vector2d& v) { return {v.y(), -v.x()}; }

}  // namespace

Vector6 between_residual(const Pose& T_from_to, const Pose& T_world_from, const Pose& T_world_to) {
  const Pose error = T_from_to.inverse() * (T_world_from.inverse() * T_world_to);
  Vector6 r;
  r << error.translation(), so3::log(error.rotation());
  return r;
}

Vector3 between_residual(const Pose2& T_from_to, const Pose2& T_world_from, const Pose2& T_world_to) {
  const Pose2 error = T_from_to.inverse() * (T_world_from.inverse() * T_world_to);
  return {error.translation().x(), error.translation().y(), error.theta()};
}

BetweenFactor<Pose> linearize(const Pose& T_from_to, const Pose& T_world_from, const Pose& T_world_to) {
  return linearize(T_from_to, T_world_from.inverse() * T_world_to);
}

BetweenFactor<Pose> linearize(const Pose& T_from_to, const Pose& estimate) {
  const Pose error = T_from_to.inverse() * estimate;
  const Vector3 angle = so3::log(error.rotation());
  const Matrix3 R_to_from = T_from_to.rotation_matrix().transpose();
  // Jr^-1(phi) = Jl^-1(-phi): how Log(R_E Exp(d)) grows with d.
  const Matrix3 J = so3::left_jacobian_inverse(-angle);
  BetweenFactor<Pose> f;
  f.residual << error.translation(), angle;
  f.d_from << -R_to_from, R_to_from * so3::hat(estimate.translation()),  //
      Matrix3::Zero(), -J * estimate.rotation_matrix().transpose();
  f.d_to << error.rotation_matrix(), Matrix3::Zero(),  //
      Matrix3::Zero(), J;
  return f;
}

BetweenFactor<Pose2> linearize(const Pose2& T_from_to, const Pose2& T_world_from, const Pose2& T_world_to) {
  return linearize(T_from_to, T_world_from.inverse() * T_world_to);
}

BetweenFactor<Pose2> linearize(const Pose2& T_from_to, const Pose2& estimate) {
  const Pose2 error = T_from_to.inverse() * estimate;
  const Eigen::Matrix2d R_to_from = T_from_to.rotation_matrix().transpose();
  BetweenFactor<Pose2> f;
  f.residual << error.translation(), error.theta();
  f.d_from << -R_to_from, R_to_from * clockwise(estimate.translation()), 0.0, 0.0, -1.0;
  f.d_to << error.rotation_matrix(), Eigen::Vector2d::Zero(), 0.0, 0.0, 1.0;
  return f;
}

Pose retract(const Pose& T, const Vector6& step) {
  return T * Pose(so3::exp(step.tail<3>()), step.head<3>());
}

Pose2 retract(const Pose2& T, const Vector3& step) { return T * Pose2(step.x(), step.y(), step.z()); }

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace adit {

/// In double precision. Those of size 6 that belong to a pose are in the order [translation; rotation].
///@{
using Vector3 = Eigen::Vector3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix3 = Eigen::Matrix3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
///@}

/// Lie-algebra maps of SO(3). `phi` is axis * angle in radians. All of them switch to their series near zero,
/// and `log` is exact up to and including half a turn. Source: Sola, Deray, Atchuthan, "A micro Lie theory",
/// appendix B.
namespace so3 {
/// The matrix of the cross product: hat(v) w = v x w.
[[nodiscard]] Matrix3 hat(const Vector3& v);
/// The rotation about `phi` by its length. A unit quaternion.
[[nodiscard]] Eigen::Quaterniond exp(const Vector3& phi);
/// The inverse of `exp`, of length 0 to pi. `q` is a unit quaternion; its sign does not matter.
[[nodiscard]] Vector3 log(const Eigen::Quaterniond& q);
/// d exp(phi + d) ~ exp(left_jacobian(phi) d) exp(phi).
[[nodiscard]] Matrix3 left_jacobian(const Vector3& phi);
/// The inverse matrix of left_jacobian(phi); finite below a whole turn.
[[nodiscard]] Matrix3 left_jacobian_inverse(const Vector3& phi);
}  // namespace so3

/// A rigid motion of space, SE(3). Named T_a_b: `p_a = T_a_b * p_b`, so `T_a_c = T_a_b * T_b_c`.
/// Invariant: all numbers finite, rotation a unit quaternion; checked when a pose is made from outside
/// numbers. Tangent vectors are [translation; rotation], metres and radians.
class Pose {
 public:
  /// For code that is written for Pose and Pose2 alike: degrees of freedom, and vectors and matrices of that
  /// size.
  ///@{
  static constexpr int kDof = 6;
  using Tangent = Vector6;
  using Jacobian = Matrix6;
  ///@}

  Pose() = default;  ///< Identity.
  /// Throws ContractViolation when a number is not finite or the quaternion's norm differs from 1 by more
  /// than 1e-3; within that it is normalised.
  Pose(const Eigen::Quaterniond& rotation, const Vector3& translation);
  /// Throws ContractViolation when `rotation` is off a rotation matrix by more than 1e-3; within that the
  /// nearest rotation is taken.
  Pose(const Matrix3& rotation, const Vector3& translation);
  /// Without rotation, at (x, y, z), metres. Throws like the constructors.
  [[nodiscard]] static Pose translation_of(double x, double y, double z) {
    return {Eigen::Quaterniond::Identity(), Vector3(x, y, z)};
  }
  /// Rotation about z by `yaw` radians, at (x, y, z).
  [[nodiscard]] static Pose planar(double x, double y, double yaw, double z = 0.0);
  /// Rows 0-2 of a 4x4 homogeneous matrix; same checks as the constructor.
  [[nodiscard]] static Pose from_matrix(const Eigen::Matrix4d& T);

  /// Where the constant twist `xi` leads from the identity in unit time.
  [[nodiscard]] static Pose exp(const Tangent& xi);
  /// The twist whose `exp` is this pose; it turns by at most pi.
  [[nodiscard]] Tangent log() const;

  /// The parts of T_a_b: p_a = rotation() * p_b + translation(), metres. The quaternion has unit length.
  ///@{
  [[nodiscard]] const Eigen::Quaterniond& rotation() const { return q_; }
  [[nodiscard]] const Vector3& translation() const { return t_; }
  [[nodiscard]] Matrix3 rotation_matrix() const { return q_.toRotationMatrix(); }
  ///@}
  [[nodiscard]] Eigen::Matrix4d matrix() const;  ///< Homogeneous; the last row is 0 0 0 1.
  [[nodiscard]] double yaw() const;              ///< Heading of the x axis in the xy plane, radians.
  [[nodiscard]] double angle() const;            ///< Size of the rotation, radians, in [0, pi].

  [[nodiscard]] Pose inverse() const;  ///< T_b_a of T_a_b.
  /// T_a_c = T_a_b * T_b_c. The quaternion is normalised, so that long products stay poses.
  Pose operator*(const Pose& other) const;
  /// p_a = T_a_b * p_b.
  Vector3 operator*(const Vector3& p) const { return q_ * p + t_; }

  /// Ad: T exp(xi) = exp(Ad(T) xi) T.
  [[nodiscard]] Matrix6 adjoint() const;
  /// Jr: exp(xi + d) ~ exp(xi) exp(right_jacobian(xi) d).
  [[nodiscard]] static Matrix6 right_jacobian(const Tangent& xi);
  /// The inverse matrix of that: log(exp(xi) exp(d)) ~ xi + right_jacobian_inverse(xi) d.
  [[nodiscard]] static Matrix6 right_jacobian_inverse(const Tangent& xi);

 private:
  Eigen::Quaterniond q_ = Eigen::Quaterniond::Identity();
  Vector3 t_ = Vector3::Zero();
};

/// On the geodesic from `a` (s = 0) to `b` (s = 1); s outside [0, 1] extrapolates with the same twist.
[[nodiscard]] Pose interpolate(const Pose& a, const Pose& b, double s);

/// A rigid motion of the plane, SE(2), with the same conventions. Angle kept in (-pi, pi].
class Pose2 {
 public:
  /// As in Pose.
  ///@{
  static constexpr int kDof = 3;
  using Tangent = Eigen::Vector3d;
  using Jacobian = Matrix3;
  ///@}

  Pose2() = default;
  /// Throws ContractViolation when a number is not finite.
  Pose2(double x, double y, double theta);

  /// The parts of T_a_b: p_a = rotation_matrix() * p_b + translation(), metres; `theta` in radians.
  ///@{
  [[nodiscard]] const Eigen::Vector2d& translation() const { return t_; }
  [[nodiscard]] double theta() const { return theta_; }
  [[nodiscard]] Eigen::Matrix2d rotation_matrix() const;
  ///@}
  [[nodiscard]] Pose2 inverse() const;  ///< T_b_a of T_a_b.
  /// T_a_c = T_a_b * T_b_c.
  Pose2 operator*(const Pose2& other) const;
  /// p_a = T_a_b * p_b.
  Eigen::Vector2d operator*(const Eigen::Vector2d& p) const { return rotation_matrix() * p + t_; }
  /// Where the constant twist `xi`, [x; y; theta], leads from the identity in unit time.
  [[nodiscard]] static Pose2 exp(const Tangent& xi);
  /// The twist whose `exp` is this pose; it turns by at most pi.
  [[nodiscard]] Tangent log() const;
  /// Ad: T exp(xi) = exp(Ad(T) xi) T.
  [[nodiscard]] Matrix3 adjoint() const;

 private:
  Eigen::Vector2d t_ = Eigen::Vector2d::Zero();
  double theta_ = 0.0;
};

/// The covariance of Ad d, where d has `covariance`: carries the covariance of a perturbation to another
/// frame.
///@{
[[nodiscard]] Matrix6 carry_covariance(const Matrix6& adjoint, const Matrix6& covariance);
[[nodiscard]] Matrix3 carry_covariance(const Matrix3& adjoint, const Matrix3& covariance);
///@}

/// `angle` brought into (-pi, pi].
[[nodiscard]] double wrap_angle(double angle);

}  // namespace adit

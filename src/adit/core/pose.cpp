// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/pose.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "adit/core/check.hpp"
#include "adit/core/decompositions.hpp"

namespace adit {
namespace {

// Below this angle the closed forms lose digits to cancellation and the series are exact to the last bit or
// two.
constexpr double kSmallAngle = 1e-4;

// Q of Barfoot, "State Estimation for Robotics", eq. (7.86): the translation-rotation block of the left
// Jacobian.
Matrix3 left_jacobian_coupling(const Vector3& rho, const Vector3& phi) {
  const double t2 = phi.squaredNorm();
  const double t = std::sqrt(t2);
  double a = 0.0;  // (t - sin t) / t^3
  double b = 0.0;  // (t^2/2 + cos t - 1) / t^4
  double c = 0.0;  // (2t - 3 sin t + t cos t) / (2 t^5)
  if (t < 0.02) {  // t^5 in a denominator: switch earlier than elsewhere
    a = 1.0 / 6.0 - t2 / 120.0 + t2 * t2 / 5040.0;
    b = 1.0 / 24.0 - t2 / 720.0 + t2 * t2 / 40320.0;
    c = 1.0 / 120.0 - t2 / 2520.0 + t2 * t2 / 120960.0;
  } else {
    const double s = std::sin(t);
    const double k = std::cos(t);
    a = (t - s) / (t2 * t);
    b = (0.5 * t2 + k - 1.0) / (t2 * t2);
    c = (2.0 * t - 3.0 * s + t * k) / (2.0 * t2 * t2 * t);
  }
  const Matrix3 P = so3::hat(phi);
  const Matrix3 R = so3::hat(rho);
  const Matrix3 PR = P * R;
  const Matrix3 RP = R * P;
  const Matrix3 PRP = PR * P;
  return 0.5 * R + a * (PR + RP + PRP) + b * (P * PR + RP * P - 3.0 * PRP) + c * (PRP * P + P * PRP);
}

Matrix6 left_jacobian(const Vector6& xi) {
  const Matrix3 J = so3::left_jacobian(xi.tail<3>());
  Matrix6 out = Matrix6::Zero();
  out.topLeftCorner<3, 3>() = J;
  out.bottomRightCorner<3, 3>() = J;
  out.topRightCorner<3, 3>() = left_jacobian_coupling(xi.head<3>(), xi.tail<3>());
  return out;
}

}  // namespace

namespace so3 {

Matrix3 hat(const Vector3& v) {
  Matrix3 m;
  m << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
  return m;
}

Eigen::Quaterniond exp(const Vector3& phi) {
  const double angle2 = phi.squaredNorm();
  const double angle = std::sqrt(angle2);
  const double k = angle < kSmallAngle ? 0.5 - angle2 / 48.0 : std::sin(0.5 * angle) / angle;
  return Eigen::Quaterniond(std::cos(0.5 * angle), k * phi.x(), k * phi.y(), k * phi.z()).normalized();
}

Vector3 log(const Eigen::Quaterniond& q) {
  // q and -q are the same rotation: take the half with w >= 0, so that the angle is at most pi.
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const double w = sign * q.w();
  const Vector3 v = sign * q.vec();
  const double n = v.norm();
  // atan2 stays exact at half a turn, where acos(w) loses half of its digits.
  const double k =
      n < 0.5 * kSmallAngle ? 2.0 / w - 2.0 * n * n / (3.0 * w * w * w) : 2.0 * std::atan2(n, w) / n;
  return k * v;
}

Matrix3 left_jacobian(const Vector3& phi) {
  const double t2 = phi.squaredNorm();
  const double t = std::sqrt(t2);
  const double h = t < kSmallAngle ? 0.5 - t2 / 48.0 : std::sin(0.5 * t) / t;
  const double a = 2.0 * h * h;  // (1 - cos t) / t^2 without its cancellation
  const double b = t < 1e-2 ? 1.0 / 6.0 - t2 / 120.0 + t2 * t2 / 5040.0 : (t - std::sin(t)) / (t2 * t);
  const Matrix3 P = hat(phi);
  return Matrix3::Identity() + a * P + b * P * P;
}

Matrix3 left_jacobian_inverse(const Vector3& phi) {
  const double t2 = phi.squaredNorm();
  const double t = std::sqrt(t2);
  const Matrix3 P = hat(phi);
  // (1 - (t/2) cot(t/2)) / t^2
  const double c = t < 1e-2 ? 1.0 / 12.0 + t2 / 720.0 + t2 * t2 / 30240.0
                            : (1.0 - 0.5 * t * std::cos(0.5 * t) / std::sin(0.5 * t)) / t2;
  return Matrix3::Identity() - 0.5 * P + c * P * P;
}

}  // namespace so3

Pose::Pose(const Eigen::Quaterniond& rotation, const Vector3& translation) : q_(rotation), t_(translation) {
  ADIT_CHECK(rotation.coeffs().allFinite() && translation.allFinite(), "a pose has only finite numbers");
  ADIT_CHECK(std::abs(rotation.norm() - 1.0) < 1e-3, "a pose's quaternion has norm 1");
  // One that is as good as it gets stays bit for bit, so that poses survive being written and read.
  if (std::abs(q_.squaredNorm() - 1.0) > 1e-15) q_.normalize();
}

Pose::Pose(const Matrix3& rotation, const Vector3& translation) : t_(translation) {
  ADIT_CHECK(rotation.allFinite() && translation.allFinite(), "a pose has only finite numbers");
  const Matrix3 gram = rotation.transpose() * rotation;
  ADIT_CHECK((gram - Matrix3::Identity()).norm() < 1e-3 && rotation.determinant() > 0.0,
             "a pose's rotation is orthonormal and right-handed");
  // Most matrices come from products of exact rotations; only those read from text need the nearest rotation.
  if ((gram - Matrix3::Identity()).norm() > 1e-9) {
    const auto [u, singular_values, v] = svd(rotation);
    q_ = Eigen::Quaterniond(Matrix3(u * v.transpose()));
  } else {
    q_ = Eigen::Quaterniond(rotation);
  }
  q_.normalize();
}

Pose Pose::planar(double x, double y, double yaw, double z) {
  return {Eigen::Quaterniond(std::cos(0.5 * yaw), 0.0, 0.0, std::sin(0.5 * yaw)), Vector3(x, y, z)};
}

Pose Pose::from_matrix(const Eigen::Matrix4d& T) {
  return {Matrix3(T.topLeftCorner<3, 3>()), Vector3(T.topRightCorner<3, 1>())};
}

Pose Pose::exp(const Tangent& xi) {
  const Vector3 phi = xi.tail<3>();
  return {so3::exp(phi), so3::left_jacobian(phi) * xi.head<3>()};
}

Pose::Tangent Pose::log() const {
  const Vector3 phi = so3::log(q_);
  Tangent xi;
  xi << so3::left_jacobian_inverse(phi) * t_, phi;
  return xi;
}

Eigen::Matrix4d Pose::matrix() const {
  Eigen::Matrix4d T = Eigen::Matrix4d::Identity();
  T.topLeftCorner<3, 3>() = rotation_matrix();
  T.topRightCorner<3, 1>() = t_;
  return T;
}

double Pose::yaw() const {
  const Vector3 x = q_ * Vector3::UnitX();
  return std::atan2(x.y(), x.x());
}

double Pose::angle() const { return 2.0 * std::atan2(q_.vec().norm(), std::abs(q_.w())); }

Pose Pose::inverse() const {
  Pose out;
  out.q_ = q_.conjugate();
  out.t_ = -(out.q_ * t_);
  return out;
}

Pose Pose::operator*(const Pose& other) const {
  Pose out;
  out.q_ = (q_ * other.q_).normalized();
  out.t_ = q_ * other.t_ + t_;
  return out;
}

Matrix6 Pose::adjoint() const {
  const Matrix3 R = rotation_matrix();
  Matrix6 out = Matrix6::Zero();
  out.topLeftCorner<3, 3>() = R;
  out.bottomRightCorner<3, 3>() = R;
  out.topRightCorner<3, 3>() = so3::hat(t_) * R;
  return out;
}

Matrix6 Pose::right_jacobian(const Tangent& xi) { return left_jacobian(-xi); }

Matrix6 Pose::right_jacobian_inverse(const Tangent& xi) {
  const Matrix6 J = left_jacobian(-xi);
  const Matrix3 inverse = so3::left_jacobian_inverse(-xi.tail<3>());
  Matrix6 out = Matrix6::Zero();
  out.topLeftCorner<3, 3>() = inverse;
  out.bottomRightCorner<3, 3>() = inverse;
  out.topRightCorner<3, 3>() = -inverse * J.topRightCorner<3, 3>() * inverse;
  return out;
}

Pose interpolate(const Pose& a, const Pose& b, double s) {
  return a * Pose::exp(s * (a.inverse() * b).log());
}

Matrix6 carry_covariance(const Matrix6& adjoint, const Matrix6& covariance) {
  return adjoint * covariance * adjoint.transpose();
}

Matrix3 carry_covariance(const Matrix3& adjoint, const Matrix3& covariance) {
  return adjoint * covariance * adjoint.transpose();
}

double wrap_angle(double angle) {
  if (angle > -std::numbers::pi && angle <= std::numbers::pi) return angle;
  const double wrapped = std::remainder(angle, 2.0 * std::numbers::pi);
  return wrapped <= -std::numbers::pi ? std::numbers::pi : wrapped;
}

Pose2::Pose2(double x, double y, double theta) : t_(x, y), theta_(wrap_angle(theta)) {
  ADIT_CHECK(std::isfinite(x) && std::isfinite(y) && std::isfinite(theta), "a pose has only finite numbers");
}

Eigen::Matrix2d Pose2::rotation_matrix() const { return Eigen::Rotation2Dd(theta_).toRotationMatrix(); }

Pose2 Pose2::inverse() const {
  const Eigen::Vector2d t = -(rotation_matrix().transpose() * t_);
  return {t.x(), t.y(), -theta_};
}

Pose2 Pose2::operator*(const Pose2& other) const {
  const Eigen::Vector2d t = rotation_matrix() * other.t_ + t_;
  return {t.x(), t.y(), theta_ + other.theta_};
}

Pose2 Pose2::exp(const Tangent& xi) {
  const double th = xi.z();
  const double a = std::abs(th) < kSmallAngle ? 1.0 - th * th / 6.0 : std::sin(th) / th;
  const double h = std::abs(th) < kSmallAngle ? 0.5 - th * th / 48.0 : std::sin(0.5 * th) / th;
  const double b = 2.0 * h * h * th;  // (1 - cos theta) / theta without its cancellation
  return {a * xi.x() - b * xi.y(), b * xi.x() + a * xi.y(), th};
}

Pose2::Tangent Pose2::log() const {
  const double half = 0.5 * theta_;
  const double a = std::abs(half) < kSmallAngle ? 1.0 - half * half / 3.0 : half / std::tan(half);
  return {a * t_.x() + half * t_.y(), -half * t_.x() + a * t_.y(), theta_};
}

Matrix3 Pose2::adjoint() const {
  Matrix3 out = Matrix3::Identity();
  out.topLeftCorner<2, 2>() = rotation_matrix();
  out(0, 2) = t_.y();
  out(1, 2) = -t_.x();
  return out;
}

}  // namespace adit

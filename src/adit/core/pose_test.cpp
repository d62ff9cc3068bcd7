// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/pose.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr double kPi = std::numbers::pi;

Eigen::Matrix4d matrix_of(const Pose& T) { return T.matrix(); }
Eigen::Matrix3d matrix_of(const Pose2& T) {
  Eigen::Matrix3d M = Eigen::Matrix3d::Identity();
  M.topLeftCorner<2, 2>() = T.rotation_matrix();
  M.topRightCorner<2, 1>() = T.translation();
  return M;
}

template <class P>
double gap(const P& a, const P& b) {
  return (matrix_of(a) - matrix_of(b)).norm();
}

/// Rotations at and around every switch of formula: zero, both sides of the series' borders, and half a turn.
const std::vector<double> kAngles = {0.0,        1e-300,     1e-12,       1e-8,  0.99e-4, 1.01e-4,
                                     0.99e-2,    1.01e-2,    0.019,       0.021, 0.5,     kPi / 2.0,
                                     kPi - 1e-4, kPi - 1e-8, kPi - 1e-12, kPi};

/// The laws of a Lie group, for SE(3) and SE(2) alike.
template <class P>
class LieGroup : public testing::Test {
 public:
  using Tangent = typename P::Tangent;

  Tangent random_tangent(double size = 1.0) {
    Tangent xi;
    for (double& x : xi) x = rng_.uniform(-size, size);
    return xi;
  }
  P random() { return P::exp(random_tangent(3.0)); }

  /// With a rotation by exactly `angle` about a random axis, of either sign.
  Tangent tangent_of_angle(double angle) {
    Tangent xi = random_tangent(5.0);
    if constexpr (P::kDof == 6) {
      xi.template tail<3>() = angle * Vector3(rng_.normal(), rng_.normal(), rng_.normal()).normalized();
    } else {
      xi[2] = rng_.uniform() < 0.5 && angle < kPi ? -angle : angle;
    }
    return xi;
  }

 private:
  Rng rng_{7};
};
using Groups = testing::Types<Pose, Pose2>;
TYPED_TEST_SUITE(LieGroup, Groups);

TYPED_TEST(LieGroup, GroupAxioms) {
  for (int i = 0; i < 100; ++i) {
    const TypeParam a = this->random();
    const TypeParam b = this->random();
    const TypeParam c = this->random();
    EXPECT_LT(gap((a * b) * c, a * (b * c)), 1e-13);
    EXPECT_LT(gap(a * TypeParam(), a), 4e-15);
    EXPECT_LT(gap(TypeParam() * a, a), 4e-15);
    EXPECT_LT(gap(a * a.inverse(), TypeParam()), 1e-14);
    EXPECT_LT(gap(a.inverse() * a, TypeParam()), 1e-14);
    EXPECT_LT((matrix_of(a * b) - matrix_of(a) * matrix_of(b)).norm(), 1e-13);
  }
}

TYPED_TEST(LieGroup, ActsOnPoints) {
  for (int i = 0; i < 100; ++i) {
    const TypeParam a = this->random();
    const TypeParam b = this->random();
    const auto p = this->random().translation();
    EXPECT_LT(((a * b) * p - a * (b * p)).norm(), 1e-13);
    EXPECT_LT((TypeParam() * p - p).norm(), 1e-15);
  }
}

TYPED_TEST(LieGroup, ExpAndLogAreInverse) {
  for (const double angle : kAngles) {
    for (int i = 0; i < 20; ++i) {
      const auto xi = this->tangent_of_angle(angle);
      const TypeParam T = TypeParam::exp(xi);
      EXPECT_LT(gap(TypeParam::exp(T.log()), T), 1e-13) << "angle " << angle;
      // At half a turn the axis may come back reversed; everywhere else the tangent itself comes back.
      if (angle < kPi - 1e-13) {
        EXPECT_LT((T.log() - xi).norm(), 1e-11) << "angle " << angle;
      }
    }
  }
  EXPECT_EQ(TypeParam().log().norm(), 0.0);
  EXPECT_EQ(gap(TypeParam::exp(TypeParam::Tangent::Zero()), TypeParam()), 0.0);
}

TYPED_TEST(LieGroup, ExpOfTheOppositeIsTheInverse) {
  for (const double angle : kAngles) {
    const auto xi = this->tangent_of_angle(angle);
    EXPECT_LT(gap(TypeParam::exp(-xi), TypeParam::exp(xi).inverse()), 1e-13) << "angle " << angle;
  }
}

TYPED_TEST(LieGroup, StepsAlongOneTwistAddUp) {
  for (const double angle : kAngles) {
    const auto xi = this->tangent_of_angle(angle);
    EXPECT_LT(gap(TypeParam::exp(0.3 * xi) * TypeParam::exp(0.7 * xi), TypeParam::exp(xi)), 1e-13) << angle;
  }
}

TYPED_TEST(LieGroup, ExpIsTheMatrixExponential) {
  for (const double angle : kAngles) {
    const auto xi = this->tangent_of_angle(angle);
    // (1 + x / 2^k) squared k times, with a Taylor term more for accuracy.
    auto twist = matrix_of(TypeParam());
    twist.setZero();
    if constexpr (TypeParam::kDof == 6) {
      twist.template topLeftCorner<3, 3>() = so3::hat(xi.template tail<3>());
      twist.template topRightCorner<3, 1>() = xi.template head<3>();
    } else {
      twist.template topLeftCorner<2, 2>() << 0.0, -xi[2], xi[2], 0.0;
      twist.template topRightCorner<2, 1>() = xi.template head<2>();
    }
    auto sum = matrix_of(TypeParam());
    auto term = sum;
    for (int k = 1; k < 40; ++k) {
      term = (term * twist / k).eval();
      sum += term;
    }
    EXPECT_LT((matrix_of(TypeParam::exp(xi)) - sum).norm(), 1e-12) << "angle " << angle;
  }
}

TYPED_TEST(LieGroup, AdjointMovesATwistThroughThePose) {
  using Jacobian = typename TypeParam::Jacobian;
  for (int i = 0; i < 100; ++i) {
    const TypeParam T = this->random();
    const typename TypeParam::Tangent xi = this->random_tangent();
    EXPECT_LT(gap(T * TypeParam::exp(xi), TypeParam::exp(T.adjoint() * xi) * T), 1e-12);
    const TypeParam S = this->random();
    EXPECT_LT(((T * S).adjoint() - T.adjoint() * S.adjoint()).norm(), 1e-12);
    EXPECT_LT((T.inverse().adjoint() * T.adjoint() - Jacobian::Identity()).norm(), 1e-12);
    const Jacobian covariance = xi * xi.transpose();
    const typename TypeParam::Tangent carried = T.adjoint() * xi;
    EXPECT_LT((carry_covariance(T.adjoint(), covariance) - carried * carried.transpose()).norm(), 1e-11);
  }
}

class PoseLaws : public LieGroup<Pose> {};

TEST_F(PoseLaws, RightJacobianIsTheDerivativeOfExp) {
  constexpr double kStep = 1e-5;
  for (const double angle : kAngles) {
    const Vector6 xi = tangent_of_angle(angle);
    Matrix6 numeric;
    for (int i = 0; i < 6; ++i) {
      const Vector6 d = kStep * Vector6::Unit(i);
      const Vector6 forward = (Pose::exp(xi).inverse() * Pose::exp(xi + d)).log();
      const Vector6 backward = (Pose::exp(xi).inverse() * Pose::exp(xi - d)).log();
      numeric.col(i) = (forward - backward) / (2.0 * kStep);
    }
    EXPECT_LT((Pose::right_jacobian(xi) - numeric).norm(), 1e-8) << "angle " << angle;
    EXPECT_LT((Pose::right_jacobian(xi) * Pose::right_jacobian_inverse(xi) - Matrix6::Identity()).norm(),
              1e-11);
  }
}

TEST_F(PoseLaws, JacobiansDoNotJumpWhereTheFormulaChanges) {
  for (const double border : {1e-4, 1e-2, 0.02}) {
    const Vector6 unit = tangent_of_angle(1.0);
    const auto at = [&](double angle) {
      Vector6 xi = unit;
      xi.tail<3>() *= angle;
      return xi;
    };
    const double below = border * (1.0 - 1e-9);
    const double above = border * (1.0 + 1e-9);
    EXPECT_LT((Pose::right_jacobian(at(below)) - Pose::right_jacobian(at(above))).norm(), 1e-9);
    EXPECT_LT((Pose::right_jacobian_inverse(at(below)) - Pose::right_jacobian_inverse(at(above))).norm(),
              1e-9);
  }
}

TEST_F(PoseLaws, InterpolationRunsAlongTheGeodesic) {
  for (int i = 0; i < 50; ++i) {
    const Pose a = random();
    const Pose b = random();
    EXPECT_LT(gap(interpolate(a, b, 0.0), a), 1e-13);
    EXPECT_LT(gap(interpolate(a, b, 1.0), b), 1e-12);
    const Pose half = interpolate(a, b, 0.5);
    EXPECT_LT(gap(half * (a.inverse() * half), b), 1e-12);
    EXPECT_LT(gap(interpolate(b, a, 0.25), interpolate(a, b, 0.75)), 1e-11);
    const Pose third = random();
    EXPECT_LT(gap(interpolate(third * a, third * b, 0.3), third * interpolate(a, b, 0.3)), 1e-11);
  }
}

TEST_F(PoseLaws, LogOfHalfATurnAboutEachAxis) {
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 half_turn = kPi * Vector3::Unit(axis);
    EXPECT_NEAR(so3::log(so3::exp(half_turn)).norm(), kPi, 1e-15);
    EXPECT_LT((so3::log(so3::exp(half_turn)).cwiseAbs() - half_turn).norm(), 1e-15);
  }
  const Eigen::Quaterniond q = so3::exp(Vector3(0.3, -0.2, 0.1));
  EXPECT_LT((so3::log(q) - so3::log(Eigen::Quaterniond(-q.coeffs()))).norm(),
            1e-15);  // One rotation, two quaternions.
}

TEST_F(PoseLaws, YawAndAngle) {
  EXPECT_NEAR(Pose::planar(1, 2, 0.7, 3).yaw(), 0.7, 1e-15);
  EXPECT_NEAR(Pose::planar(1, 2, -3.0).angle(), 3.0, 1e-15);
  EXPECT_EQ(Pose::planar(1, 2, 0.7, 3).translation(), Vector3(1, 2, 3));
  EXPECT_EQ(Pose::translation_of(1, 2, 3).angle(), 0.0);
  EXPECT_NEAR(Pose::exp(tangent_of_angle(kPi)).angle(), kPi, 1e-14);
}

TEST_F(PoseLaws, RefusesNumbersThatAreNoPose) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const Eigen::Quaterniond one = Eigen::Quaterniond::Identity();
  EXPECT_THROW(Pose(one, Vector3(0, nan, 0)), ContractViolation);
  EXPECT_THROW(Pose(one, Vector3(0, infinity, 0)), ContractViolation);
  EXPECT_THROW(Pose(Eigen::Quaterniond(0, 0, 0, 0), Vector3::Zero()), ContractViolation);
  EXPECT_THROW(Pose(Eigen::Quaterniond(1.01, 0, 0, 0), Vector3::Zero()), ContractViolation);
  EXPECT_THROW(Pose(Matrix3(2.0 * Matrix3::Identity()), Vector3::Zero()), ContractViolation);
  EXPECT_THROW(Pose(Matrix3(Vector3(1, 1, -1).asDiagonal()), Vector3::Zero()), ContractViolation);
  EXPECT_THROW(Pose2(0, 0, nan), ContractViolation);
  const Pose text(Eigen::Quaterniond(0.70711, 0, 0, 0.70711),
                  Vector3::Zero());  // Five digits, as files have them.
  EXPECT_NEAR(text.rotation().norm(), 1.0, 1e-15);
}

TEST_F(PoseLaws, NearlyRotationMatricesAreMadeExact) {
  for (int i = 0; i < 20; ++i) {
    const Pose T = random();
    const Matrix3 noisy = T.rotation_matrix() + 1e-5 * Matrix3::Random();
    const Pose repaired(noisy, T.translation());
    EXPECT_LT(gap(repaired, T), 1e-4);
    EXPECT_LT(
        (repaired.rotation_matrix().transpose() * repaired.rotation_matrix() - Matrix3::Identity()).norm(),
        1e-14);
    EXPECT_LT(gap(Pose::from_matrix(T.matrix()), T), 1e-14);
  }
}

TEST(WrapAngle, KeepsTheHalfOpenInterval) {
  EXPECT_EQ(wrap_angle(kPi), kPi);
  EXPECT_EQ(wrap_angle(-kPi), kPi);
  EXPECT_EQ(wrap_angle(0.0), 0.0);
  EXPECT_NEAR(wrap_angle(3.0 * kPi), kPi, 1e-14);
  EXPECT_NEAR(wrap_angle(2.0 * kPi + 0.1), 0.1, 1e-14);
  EXPECT_NEAR(wrap_angle(-100.0), -100.0 + 32.0 * kPi, 1e-12);
}

}  // namespace
}  // namespace adit

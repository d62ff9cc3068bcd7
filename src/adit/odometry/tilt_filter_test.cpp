// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/tilt_filter.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "adit/core/angles.hpp"
#include "adit/odometry/imu_integral.hpp"

namespace adit {
namespace {

void drive_on(TiltFilter& filter, const Vector3& up, int metres = 20,
              const Matrix3& R_odom_base = Matrix3::Identity()) {
  for (int i = 0; i < metres; ++i) filter.measure(kGravity * up, R_odom_base, 1.0, 1.0);
}

Vector3 leaning(double deg) { return Eigen::AngleAxisd(deg * kDegree, Vector3::UnitY()) * Vector3::UnitZ(); }

double turn_deg(const TiltFilter& filter) {
  return Eigen::AngleAxisd(filter.R_start_now()).angle() / kDegree;
}

TEST(TiltFilter, ABlowIsNoTilt) {
  TiltFilter filter({});
  for (int i = 0; i < 20; ++i) filter.measure(kGravity * Vector3::UnitZ(), Matrix3::Identity(), 1.0, 1.0);
  filter.measure({5.0, 0.0, kGravity}, Matrix3::Identity(), 1.0, 1.0);
  EXPECT_LT(filter.R_start_now().angularDistance(Eigen::Quaterniond::Identity()), 1e-9);
  for (int i = 0; i < 200; ++i)
    filter.measure({0.1, 0.0, kGravity}, Matrix3::Identity(), 1.0, 1.0);  // 0.6 degrees
  // Up leans forward now: it is turned back about y.
  const Eigen::AngleAxisd turn(filter.R_start_now());
  EXPECT_GT(turn.angle(), 0.25 * kDegree);
  EXPECT_LT(turn.angle(), 0.6 * kDegree);
  EXPECT_LT((filter.R_start_now() * Vector3(0.1, 0.0, kGravity).normalized()).x(), 0.1 / kGravity);
}

TEST(TiltFilter, AfterAJumpThatWasExpectedUpIsLearntAnew) {
  TiltFilter filter({});
  drive_on(filter, Vector3::UnitZ());
  const Vector3 up = leaning(20.0);
  TiltFilter not_expecting = filter;
  drive_on(not_expecting, up);
  EXPECT_LT(turn_deg(not_expecting), 1e-6);
  filter.expect_jump();
  drive_on(filter, up);
  EXPECT_LT((filter.R_start_now() * up - Vector3::UnitZ()).norm(), 0.01);
}

TEST(TiltFilter, OfTwoFirstForcesThatDisagreeNeitherCounts) {
  TiltFilter filter({});
  drive_on(filter, leaning(30.0), 1);
  drive_on(filter, Vector3::UnitZ(), 200);
  EXPECT_LT(turn_deg(filter), 1e-6);
  drive_on(filter, leaning(0.6), 200);
  EXPECT_GT(turn_deg(filter), 0.25);
}

// What leans with the body is an offset, and what stays as the body turns is a tilt.
TEST(TiltFilter, AnOffsetTurnsWithTheRobotAndATiltDoesNot) {
  constexpr double kLean = 1.5;
  const auto turned_after = [](bool leans_with_body) {
    TiltFilter filter({});
    double turned = 0.0;
    for (int quarter = 0; quarter < 8; ++quarter) {
      const Matrix3 R(Eigen::AngleAxisd(0.5 * std::numbers::pi * quarter, Vector3::UnitZ()));
      drive_on(filter, leans_with_body ? Vector3(R * leaning(kLean)) : leaning(quarter == 0 ? 0.0 : kLean),
               20, R);
      turned = turn_deg(filter);
    }
    return turned;
  };
  EXPECT_LT(turned_after(true), 0.1 * kLean);
  EXPECT_GT(turned_after(false), 0.35 * kLean);
}

}  // namespace
}  // namespace adit

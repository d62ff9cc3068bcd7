// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/wheel_covariance.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace adit {
namespace {

Matrix6 diagonal(double x, double y, double z, double roll, double pitch, double yaw) {
  return Vector6(x, y, z, roll, pitch, yaw).asDiagonal();
}

TEST(WheelCovariance, WhatDriversUsuallyWriteIsNoFault) {
  for (const Matrix6& usual :
       {Matrix6(Matrix6::Zero()), diagonal(1e-3, 1e-3, 1e6, 1e6, 1e6, 1e-3), diagonal(0.1, 0.1, 0, 0, 0, 0.1),
        diagonal(1e-9, 1e-3, 1e-9, 1e6, 1e6, 1e-9)}) {
    EXPECT_EQ(fault_of_pose_covariance(usual), "") << usual;
    EXPECT_EQ(fault_of_twist_covariance(usual), "") << usual;
  }
  // That of dead reckoning over a long drive: position and heading err together.
  Matrix6 grown = diagonal(400, 900, 1e6, 1e6, 1e6, 0.04);
  grown(1, 5) = grown(5, 1) = 0.9 * 30 * 0.2;
  EXPECT_EQ(fault_of_pose_covariance(grown), "");
}

TEST(WheelCovariance, WhatCannotBeIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(fault_of_pose_covariance(diagonal(1, 1, 1, 1, nan, 1)), "not finite");
  EXPECT_EQ(fault_of_pose_covariance(diagonal(1, 1, infinite, 1, 1, 1)), "not finite");
  EXPECT_EQ(fault_of_twist_covariance(diagonal(-1, 0, 0, 0, 0, 0)), "not positive definite");
  EXPECT_EQ(fault_of_pose_covariance(diagonal(1e6, 1, 0, 0, 0, 1)), "huge (standard deviation 1e+03 m)");
  EXPECT_EQ(fault_of_pose_covariance(diagonal(1, 1, 0, 0, 0, 1e6)), "huge (standard deviation 1e+03 rad)");
  EXPECT_EQ(fault_of_twist_covariance(diagonal(1, 1e9, 0, 0, 0, 1)),
            "huge (standard deviation 3.16e+04 m/s)");
  // Not positive definite only between axes, beside a large number for one that is not measured.
  Matrix6 correlated = diagonal(1e-3, 1e-3, 1e6, 1e6, 1e6, 1e-3);
  correlated(0, 5) = correlated(5, 0) = 1.1e-3;
  EXPECT_EQ(fault_of_pose_covariance(correlated), "not positive definite");
  correlated(0, 5) = correlated(5, 0) = 0.9e-3;
  EXPECT_EQ(fault_of_pose_covariance(correlated), "");
  correlated(5, 0) = 0.0;  // not symmetric
  EXPECT_EQ(fault_of_pose_covariance(correlated), "not positive definite");
  // A row without its variance.
  Matrix6 no_variance = diagonal(1, 1, 0, 0, 0, 0);
  no_variance(0, 5) = no_variance(5, 0) = 0.1;
  EXPECT_EQ(fault_of_pose_covariance(no_variance), "not positive definite");
}

}  // namespace
}  // namespace adit

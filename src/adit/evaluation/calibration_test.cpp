// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/calibration.hpp"

#include <gtest/gtest.h>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr double kBeyond999 = 22.4577;  // chi-square of 6 degrees of freedom

Matrix6 root_of_a_covariance() {
  Rng rng(3);
  Matrix6 root;
  for (double& value : root.reshaped()) value = 0.05 * rng.normal();
  return root + 0.1 * Matrix6::Identity();
}

Vector6 normal(Rng& rng) {
  Vector6 out;
  for (double& value : out) value = rng.normal();
  return out;
}

TEST(Calibration, OneWhereTheCovarianceIsTrue) {
  const Matrix6 root = root_of_a_covariance();
  const Matrix6 covariance = root * root.transpose();
  Rng rng(4);
  Calibration calibration, too_confident, too_cautious;
  for (int i = 0; i < 20000; ++i) {
    const Vector6 error = root * normal(rng);
    calibration.add(error, covariance);
    too_confident.add(error, 0.25 * covariance);
    too_cautious.add(error, 4.0 * covariance);
  }
  EXPECT_NEAR(calibration.mean(), 1.0, 0.02);
  for (const double axis : calibration.mean_of_axes()) EXPECT_NEAR(axis, 1.0, 0.05);
  EXPECT_NEAR(calibration.share_beyond(kBeyond999), 0.001, 0.0007);
  EXPECT_NEAR(calibration.rms()[0], std::sqrt(covariance(0, 0)), 0.02 * calibration.rms()[0]);
  EXPECT_NEAR(too_confident.mean(), 4.0, 0.08);
  EXPECT_GT(too_confident.share_beyond(kBeyond999), 0.3);
  EXPECT_NEAR(too_cautious.mean(), 0.25, 0.005);
}

TEST(Calibration, JoinsThoseOfParts) {
  Rng rng(5);
  Calibration all, first, second;
  for (int i = 0; i < 100; ++i) {
    const Vector6 error = normal(rng);
    all.add(error, Matrix6::Identity());
    (i < 40 ? first : second).add(error, Matrix6::Identity());
  }
  first.add(second);
  EXPECT_EQ(first.count(), all.count());
  EXPECT_NEAR(first.mean(), all.mean(), 1e-12);
}

TEST(Calibration, WhatIsNoCovarianceIsCountedAndLeftOut) {
  Calibration calibration;
  calibration.add(Vector6::Ones(), Matrix6::Zero());
  calibration.add(Vector6::Ones(), -Matrix6::Identity());
  EXPECT_EQ(calibration.count(), 0U);
  EXPECT_EQ(calibration.num_unusable(), 2U);
  EXPECT_THROW((void)calibration.mean(), ContractViolation);
}

Vector6 noise_of(const Matrix6& diagonal_covariance, Rng& rng) {
  return diagonal_covariance.diagonal().cwiseSqrt().cwiseProduct(normal(rng));
}

// Odometry whose steps drift by the stated noise, and each pose of which has a noise of its own as stated, is
// calibrated over any stretch.
TEST(EdgeCalibration, AddsUpTheStepsAlongTheStretchAndTheNoiseOfItsEnds) {
  Matrix6 of_a_step = Matrix6::Identity() * 1e-4;
  of_a_step.bottomRightCorner<3, 3>() *= 0.01;
  const Matrix6 of_a_pose = 4.0 * of_a_step;
  for (const double metres : {1.0, 10.0}) {
    Calibration calibration;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      Rng rng(seed);
      std::vector<Pose> truth = {Pose()};
      Pose drifting;
      StatedPath path{{Pose::exp(noise_of(of_a_pose, rng))}, {Matrix6::Zero()}, {of_a_pose}};
      for (int k = 0; k < 80; ++k) {
        const Pose T_step = Pose::planar(0.5, 0.0, 0.1);
        truth.push_back(truth.back() * T_step);
        drifting = drifting * T_step * Pose::exp(noise_of(of_a_step, rng));
        path.T_odom_keyframe.push_back(drifting * Pose::exp(noise_of(of_a_pose, rng)));
        path.step_covariances.push_back(of_a_step);
        path.pose_noise.push_back(of_a_pose);
      }
      calibration.add(edge_calibration(path, truth, metres));
    }
    EXPECT_GT(calibration.count(), 150U);
    EXPECT_NEAR(calibration.mean(), 1.0, 0.1) << metres;
  }
}

}  // namespace
}  // namespace adit

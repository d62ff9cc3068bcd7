// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/path_uncertainty.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "adit/core/angles.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr double kStep = 0.1;  // metres from scan to scan

// Scan k of a drive straight ahead, registered with that information.
OdometryStep step_at(int k, const Matrix6& information) {
  OdometryStep step;
  step.T_odom_base = Pose::translation_of(k * kStep, 0.0, 0.0);
  step.information = information;
  step.status = k == 0 ? StepStatus::no_map : StepStatus::ok;
  step.num_correspondences = k == 0 ? 0 : 100;
  return step;
}

Matrix6 all_fixed() { return (Vector6() << 1e4, 2e4, 3e4, 4e5, 5e5, 6e5).finished().asDiagonal(); }

Matrix6 open_along() {
  Matrix6 information = all_fixed();
  information(0, 0) = 0.0;
  return information;
}

PathUncertainty driven(const Matrix6& information, int num_steps,
                       const std::optional<PredictedMotion>& predicted) {
  PathNoise noise;
  noise.drift_per_metre = 2.0;
  PathUncertainty path(noise);
  for (int k = 0; k <= num_steps; ++k) {
    OdometryStep step = step_at(k, information);
    step.predicted = predicted;
    path.add(step);
  }
  return path;
}

TEST(PathUncertainty, DriftGrowsWithTheDistanceInCovariancesOfARegistration) {
  const PathUncertainty path = driven(all_fixed(), 20, PredictedMotion{});
  const Matrix6 C = all_fixed().inverse();
  EXPECT_NEAR(path.drift()(0, 0) / (2.0 * 2.0 * C(0, 0)), 1.0, 1e-9);
  EXPECT_NEAR(path.drift()(5, 5) / (2.0 * 2.0 * C(5, 5)), 1.0, 1e-9);
  // What turned the robot early has moved it sideways by now: the sum over the metres left.
  EXPECT_GT(path.drift()(1, 1), 2.0 * 2.0 * C(1, 1) + 0.5 * 2.0 * C(5, 5) * std::pow(2.0, 3) / 3.0);
}

TEST(PathUncertainty, RollAndPitchDriftByErrorsThatNoScanStates) {
  const double stated = driven(1e9 * all_fixed(), 20, PredictedMotion{}).drift()(4, 4);
  EXPECT_NEAR(std::sqrt(stated), PathNoise().roll_pitch_deg * kDegree * std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(driven(1e9 * all_fixed(), 20, PredictedMotion{}).drift()(3, 3), stated, 1e-12);
  EXPECT_LT(driven(1e9 * all_fixed(), 20, PredictedMotion{}).drift()(5, 5), 1e-3 * stated);
}

TEST(PathUncertainty, OpenDirectionsAreThoseOfThePrediction) {
  PredictedMotion predicted;
  predicted.open_drift(0, 0) = 4e-4;
  const PathUncertainty path = driven(open_along(), 20, predicted);
  EXPECT_NEAR(path.drift()(0, 0), 20 * 4e-4, 1e-9);
  EXPECT_LT(path.drift()(2, 2), 1e-2 * path.drift()(0, 0) + 1e-3);
}

TEST(PathUncertainty, WithoutAStatedPredictionItIsARandomWalkWiderWhereStepsWereGuessed) {
  const PathNoise noise;
  EXPECT_NEAR(driven(open_along(), 20, {}).drift()(0, 0), noise.translation * noise.translation * 2.0, 1e-6);
  PathUncertainty guessed(noise);
  for (int k = 0; k <= 20; ++k) {
    OdometryStep step = step_at(k, open_along());
    step.is_guess = true;
    guessed.add(step);
  }
  EXPECT_NEAR(guessed.drift()(0, 0), 25.0 * noise.translation * noise.translation * 2.0, 1e-6);
}

TEST(PathUncertainty, PoseNoiseIsTheMeanSquareOfTheLastCorrections) {
  Rng rng(1);
  PathUncertainty path({});
  const Vector6 sigma = (Vector6() << 0.003, 0.002, 0.004, 0.002, 0.003, 0.0005).finished();
  for (int k = 0; k <= 400; ++k) {
    OdometryStep step = step_at(k, 1e12 * Matrix6::Identity());
    for (int a = 0; a < 6; ++a) step.correction[a] = sigma[a] * rng.normal();
    path.add(step);
  }
  for (int a = 0; a < 6; ++a) EXPECT_NEAR(std::sqrt(path.pose_noise()(a, a)) / sigma[a], 1.0, 0.35) << a;
}

TEST(PathUncertainty, WithAnImuCorrectionsOfTheSameErrorAddUp) {
  PathUncertainty path({});
  PredictedMotion by_imu;
  by_imu.by_imu = true;
  for (int k = 0; k <= 100; ++k) {
    OdometryStep step = step_at(k, 1e12 * Matrix6::Identity());
    step.predicted = by_imu;
    step.correction[2] = k % 10 < 5 ? 0.001 : -0.001;  // a bump of ten scans
    path.add(step);
  }
  // Sums of three are 3 mm for six scans in ten, and 1 mm for the others.
  EXPECT_NEAR(std::sqrt(path.pose_noise()(2, 2)), 1e-3 * std::sqrt(0.6 * 9.0 + 0.4), 1e-4);
}

TEST(PathUncertainty, RefusedScansAddNothingAndNeitherDoesStandingStill) {
  PathUncertainty path({});
  path.add(step_at(0, all_fixed()));
  path.add(step_at(1, all_fixed()));
  path.begin_edge();
  const Matrix6 before = path.drift();
  OdometryStep refused = step_at(2, all_fixed());
  refused.status = StepStatus::diverged;
  path.add(refused);
  OdometryStep resting = step_at(1, all_fixed());
  resting.num_correspondences = 0;
  path.add(resting);
  EXPECT_TRUE(path.drift().isApprox(before, 1e-12));
  EXPECT_GT(path.drift().determinant(), 0.0);
}

TEST(RandomWalk, VarianceGrowsWithTheDistanceAndNeverVanishes) {
  PathNoise noise;
  noise.translation = 0.1;
  noise.rotation_deg = 2.0;
  const Matrix6 one = random_walk(noise, 1.0);
  EXPECT_NEAR(one(0, 0), 0.01, 1e-12);
  EXPECT_NEAR(std::sqrt(one(5, 5)) / kDegree, 2.0, 1e-9);
  EXPECT_TRUE(random_walk(noise, 3.0).isApprox(3.0 * one));
  EXPECT_EQ(random_walk(noise, 0.0), random_walk(noise, 0.01));
  EXPECT_GT(random_walk(noise, 0.0).determinant(), 0.0);
}

}  // namespace
}  // namespace adit

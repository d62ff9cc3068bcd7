// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/umeyama.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

Vector3 up_to(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

Pose random_pose(Rng& rng) { return {so3::exp(up_to(rng, 1.8)), up_to(rng, 500.0)}; }

std::vector<Vector3> random_points(Rng& rng, std::size_t n) {
  std::vector<Vector3> points(n);
  for (Vector3& p : points) p = up_to(rng, 30.0);
  return points;
}

std::vector<Vector3> moved(const Pose& T, std::vector<Vector3> points) {
  for (Vector3& p : points) p = T * p;
  return points;
}

double cost(const Pose& T, const std::vector<Vector3>& source, const std::vector<Vector3>& target) {
  double sum = 0.0;
  for (std::size_t i = 0; i < source.size(); ++i) sum += (target[i] - T * source[i]).squaredNorm();
  return sum;
}

void expect_same(const Pose& a, const Pose& b, double tolerance) {
  EXPECT_LT((a.inverse() * b).log().norm(), tolerance);
}

TEST(Umeyama, RecoversKnownMotions) {
  Rng rng(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Pose T = random_pose(rng);
    const std::vector<Vector3> source = random_points(rng, 3 + rng.below(40));
    expect_same(align_rigid(source, moved(T, source)).value(), T, 1e-9);
  }
}

TEST(Umeyama, NoSmallMotionOfTheAnswerIsBetterOnNoisyPoints) {
  Rng rng(2);
  for (int trial = 0; trial < 10; ++trial) {
    const std::vector<Vector3> source = random_points(rng, 25);
    std::vector<Vector3> target = moved(random_pose(rng), source);
    for (Vector3& p : target) p += up_to(rng, 8.0);
    const Pose best = align_rigid(source, target).value();
    const double least = cost(best, source, target);
    for (int i = 0; i < 200; ++i) {
      Vector6 xi;
      xi << up_to(rng, 1.0), up_to(rng, 0.05);
      xi *= rng.uniform(1e-4, 1.0);
      EXPECT_GT(cost(best * Pose::exp(xi), source, target), least);
    }
  }
}

TEST(Umeyama, MirroredPointsGetTheBestRotationNotTheReflection) {
  Rng rng(3);
  const std::vector<Vector3> source = random_points(rng, 30);
  std::vector<Vector3> target = source;
  for (Vector3& p : target) p.z() = -p.z();
  const Pose best = align_rigid(source, target).value();
  EXPECT_NEAR(best.rotation_matrix().determinant(), 1.0, 1e-12);
  double least = std::numeric_limits<double>::infinity();
  Vector3 source_mean = Vector3::Zero();
  Vector3 target_mean = Vector3::Zero();
  for (std::size_t i = 0; i < source.size(); ++i) {
    source_mean += source[i] / 30.0;
    target_mean += target[i] / 30.0;
  }
  for (int i = 0; i < 20000; ++i) {  // brute force over rotations
    const Eigen::Quaterniond q = so3::exp(up_to(rng, 3.2));
    least = std::min(least, cost(Pose(q, target_mean - q * source_mean), source, target));
  }
  EXPECT_LE(cost(best, source, target), least);
}

TEST(Umeyama, PlanarPointsAreEnough) {
  Rng rng(4);
  std::vector<Vector3> source = random_points(rng, 20);
  for (Vector3& p : source) p.z() = 0.0;
  const Pose T = random_pose(rng);
  expect_same(align_rigid(source, moved(T, source)).value(), T, 1e-9);
}

TEST(Umeyama, AStraightDriveDoesNotRollAboutItsLine) {
  std::vector<Vector3> source;
  for (int i = 0; i < 900; ++i) source.emplace_back(0.5 * i, 0.0, 0.0);
  const Pose yaw_only = Pose::planar(300.0, -20.0, 0.7, 5.0);
  expect_same(align_rigid(source, moved(yaw_only, source)).value(), yaw_only, 1e-9);
  const Pose rolled = yaw_only * Pose(so3::exp(Vector3(1.0, 0.0, 0.0)), Vector3::Zero());
  expect_same(align_rigid(source, moved(rolled, source)).value(), yaw_only, 1e-9);
}

TEST(Umeyama, TwoPointsAndOpposedLinesAreAligned) {
  const std::vector<Vector3> source = {{0, 0, 0}, {2, 0, 0}};
  const std::vector<Vector3> target = {{1, 1, 1}, {-1, 1, 1}};
  const Pose T = align_rigid(source, target).value();
  EXPECT_LT(cost(T, source, target), 1e-18);
  EXPECT_NEAR(T.angle(), 3.14159265358979, 1e-9);
}

TEST(Umeyama, OneSpotDoesNotTurn) {
  const std::vector<Vector3> source(7, Vector3(0.1, 0.2, 0.3));
  const std::vector<Vector3> target(7, Vector3(100.1, -3.3, 7.7));
  const Pose T = align_rigid(source, target).value();
  EXPECT_EQ(T.angle(), 0.0);
  EXPECT_LT((T * source[0] - target[0]).norm(), 1e-12);
  expect_same(align_rigid(std::span(source).first(1), std::span(target).first(1)).value(), T, 1e-12);
}

TEST(Umeyama, RefusesNothingAndNaN) {
  EXPECT_FALSE(align_rigid({}, {}));
  std::vector<Vector3> points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const std::vector<Vector3> good = points;
  points[1].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(align_rigid(points, good));
  EXPECT_FALSE(align_rigid(good, points));
  EXPECT_THROW((void)align_rigid(good, std::span(good).first(2)), ContractViolation);
}

}  // namespace
}  // namespace adit

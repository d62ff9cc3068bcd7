// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/gnc_registration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

Vector3 random_vector(Rng& rng, double size) {
  return size * Vector3(rng.normal(), rng.normal(), rng.normal());
}

Pose random_pose(Rng& rng) {
  return {so3::exp(rng.uniform(0.0, std::numbers::pi) * random_vector(rng, 1.0).normalized()),
          random_vector(rng, 10.0)};
}

TEST(GncRotation, SurvivesFourFifthsOutliers) {
  for (const double outliers : {0.0, 0.2, 0.5, 0.8}) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      Rng rng(seed);
      const Matrix3 R = random_pose(rng).rotation_matrix();
      std::vector<Vector3> a;
      std::vector<Vector3> b;
      for (int k = 0; k < 200; ++k) {
        b.push_back(random_vector(rng, 10.0));
        const bool wrong = k < 200.0 * outliers;
        a.push_back(wrong ? random_vector(rng, 10.0) : Vector3(R * b.back() + random_vector(rng, 0.05)));
      }
      const auto found = gnc_rotation(a, b, 0.3, {});
      ASSERT_TRUE(found.has_value());
      EXPECT_LT(so3::log(Eigen::Quaterniond(found->R_a_b.transpose() * R)).norm(), 0.01)
          << outliers << " outliers, seed " << seed;
      EXPECT_NEAR(found->R_a_b.determinant(), 1.0, 1e-9);
    }
  }
}

TEST(GncRotation, HasNoAnswerWhenTheRotationAboutALineIsOpen) {
  std::vector<Vector3> along;
  for (int k = 1; k < 20; ++k) along.emplace_back(0.5 * k, 0.0, 0.0);
  EXPECT_FALSE(gnc_rotation(along, along, 0.1, {}).has_value());
  EXPECT_FALSE(gnc_rotation(std::vector<Vector3>(5, Vector3::Zero()),
                            std::vector<Vector3>(5, Vector3::Zero()), 0.1, {})
                   .has_value());
  EXPECT_FALSE(gnc_rotation({}, {}, 0.1, {}).has_value());
}

double truncated_cost(const std::vector<double>& values, double bound, double t) {
  double cost = 0.0;
  for (const double value : values) cost += std::min((value - t) * (value - t), bound * bound);
  return cost;
}

TEST(TruncatedMean, ReachesTheCostOfAnExhaustiveSearch) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Rng rng(seed);
    std::vector<double> values(1 + seed);
    for (double& value : values) value = 1000.0 + std::round(10.0 * rng.normal()) * 0.3;  // with ties
    const double bound = 0.5;
    double best = std::numeric_limits<double>::infinity();
    for (double t = 980.0; t < 1020.0; t += 0.01) best = std::min(best, truncated_cost(values, bound, t));
    EXPECT_LE(truncated_cost(values, bound, truncated_mean(values, bound)), best + 1e-6) << "seed " << seed;
  }
}

TEST(AlignRobustly, FindsPoseAndInliers) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Rng rng(seed);
    const Pose T_a_b = random_pose(rng);
    std::vector<Eigen::Vector3f> a;
    std::vector<Eigen::Vector3f> b;
    for (int k = 0; k < 120; ++k) {
      const Vector3 p_b = random_vector(rng, 15.0);
      b.push_back(p_b.cast<float>());
      a.push_back((k % 3 == 0 ? random_vector(rng, 15.0) : Vector3(T_a_b * p_b + random_vector(rng, 0.03)))
                      .cast<float>());
    }
    const auto found = align_robustly(a, b, 0.2, {});
    ASSERT_TRUE(found.has_value());
    const Pose error = T_a_b.inverse() * found->T_a_b;
    EXPECT_LT(error.translation().norm(), 0.1);
    EXPECT_LT(error.angle(), 0.01);
    EXPECT_GE(found->inliers.size(), 75U);
    EXPECT_TRUE(
        std::none_of(found->inliers.begin(), found->inliers.end(), [](auto k) { return k % 3 == 0; }));
  }
}

TEST(AlignRobustly, HasNoAnswerForTooFewOrCollinearPoints) {
  const std::vector<Eigen::Vector3f> two = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_FALSE(align_robustly(two, two, 0.2, {}).has_value());
  std::vector<Eigen::Vector3f> line;
  for (int k = 0; k < 30; ++k) line.emplace_back(static_cast<float>(k), 0.0F, 0.0F);
  EXPECT_FALSE(align_robustly(line, line, 0.2, {}).has_value());
  EXPECT_THROW((void)align_robustly(two, line, 0.2, {}), ContractViolation);
}

}  // namespace
}  // namespace adit

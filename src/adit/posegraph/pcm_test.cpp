// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/pcm.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "support/graphs.hpp"

namespace adit {
namespace {

struct Chains {
  std::vector<Pose> truth_a, truth_b;  // T_world_keyframe
  std::vector<Pose> odom_a, odom_b;
  std::vector<Matrix6> steps_a, steps_b;
};

Vector6 draw(const Matrix6& covariance, Rng& rng) {
  return covariance.llt().matrixL() * test::random_tangent<Pose>(rng, 1.0);
}

void drive(Rng& rng, std::size_t n, std::vector<Pose>& truth, std::vector<Pose>& odom,
           std::vector<Matrix6>& steps) {
  truth = {test::random_pose<Pose>(rng, 5.0)};
  odom = {Pose()};
  for (std::size_t k = 1; k < n; ++k) {
    const Pose step = Pose::exp((Vector6() << 1.0, 0.0, 0.0, 0.02, 0.01, 0.1).finished());
    steps.emplace_back(test::random_information<Pose>(rng, 1e-6));
    truth.push_back(truth.back() * step);
    odom.push_back(odom.back() * step * Pose::exp(draw(steps.back(), rng)));
  }
}

Chains make_chains(Rng& rng, std::size_t n) {
  Chains c;
  drive(rng, n, c.truth_a, c.odom_a, c.steps_a);
  drive(rng, n, c.truth_b, c.odom_b, c.steps_b);
  return c;
}

PcmLoop true_loop(const std::vector<Pose>& truth_a, const std::vector<Pose>& truth_b, std::size_t a,
                  std::size_t b, Rng& rng) {
  const Matrix6 covariance = test::random_information<Pose>(rng, 1e-5);
  const Pose T_a_b = truth_a[a].inverse() * truth_b[b] * Pose::exp(draw(covariance, rng));
  return {a, b, T_a_b, covariance.inverse()};
}

TEST(OdometryChain, CovarianceIsThatOfStepByStepComposition) {
  Rng rng(1);
  const Chains c = make_chains(rng, 20);
  const OdometryChain chain(c.odom_a, c.steps_a);
  Matrix6 expected = Matrix6::Zero();
  for (std::size_t k = 4; k < 15; ++k) {
    const Matrix6 back = chain.between(k, k + 1).inverse().adjoint();
    expected = back * expected * back.transpose() + c.steps_a[k];
  }
  EXPECT_LT((chain.covariance(4, 15) - expected).norm(), 1e-9 * expected.norm());
  const Matrix6 turn = chain.between(4, 15).adjoint();
  EXPECT_LT((chain.covariance(15, 4) - turn * expected * turn.transpose()).norm(), 1e-9 * expected.norm());
  EXPECT_EQ(chain.covariance(7, 7).norm(), 0.0);
}

// Odometry of a survey in coordinates of a map grid, five thousand kilometres from its origin.
TEST(OdometryChain, IsNoWorseFarFromTheOrigin) {
  Rng rng(4);
  const Chains c = make_chains(rng, 200);
  std::vector<Pose> far;
  for (const Pose& pose : c.odom_a) far.push_back(Pose::translation_of(4.5e5, 5.4e6, 300.0) * pose);
  const OdometryChain near_origin(c.odom_a, c.steps_a);
  const OdometryChain on_a_grid(far, c.steps_a);
  for (const std::size_t j : {1U, 60U, 199U}) {
    const Matrix6 expected = near_origin.covariance(j - 1, j);
    EXPECT_LT((on_a_grid.covariance(j - 1, j) - expected).norm(), 1e-6 * expected.norm()) << j;
  }
}

// True pairs of loops, drawn afresh each time, must have chi-square distances: mean 6, 1 % above the 99 %
// bound.
void expect_chi_square(bool one_robot, std::size_t b_of_first, std::size_t b_of_second) {
  Rng rng(2);
  double mean = 0.0;
  int above = 0;
  constexpr int kTrials = 2000;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Chains c = make_chains(rng, 30);
    const OdometryChain a(c.odom_a, c.steps_a);
    const OdometryChain b(c.odom_b, c.steps_b);
    const auto& truth_b = one_robot ? c.truth_a : c.truth_b;
    const PcmLoop first = true_loop(c.truth_a, truth_b, 3, b_of_first, rng);
    const PcmLoop second = true_loop(c.truth_a, truth_b, 18, b_of_second, rng);
    const double d2 = consistency_distance2(a, one_robot ? a : b, first, second);
    mean += d2 / kTrials;
    above += d2 > 16.812 ? 1 : 0;
  }
  EXPECT_NEAR(mean, 6.0, 0.4);
  EXPECT_LT(above, 45);  // expected 20
}
TEST(Pcm, DistancesOfTrueLoopsAreChiSquare) { expect_chi_square(false, 25, 9); }
TEST(Pcm, SharedOdometryCountsOnceForward) { expect_chi_square(true, 8, 26); }
TEST(Pcm, SharedOdometryCountsOnceBackward) { expect_chi_square(true, 26, 8); }

TEST(Pcm, KeepsTrueLoopsAndReportsTheRival) {
  Rng rng(3);
  const Chains c = make_chains(rng, 60);
  std::vector<PcmLoop> loops;
  for (std::size_t k = 0; k < 10; ++k)
    loops.push_back(true_loop(c.truth_a, c.truth_b, 5 * k, 55 - 5 * k, rng));
  // A look-alike gallery: all wrong by the same shift, so consistent among themselves.
  std::vector<Pose> shifted = c.truth_b;
  for (Pose& pose : shifted) pose = Pose::translation_of(0.0, 20.0, 0.0) * pose;
  for (std::size_t k = 0; k < 4; ++k) loops.push_back(true_loop(c.truth_a, shifted, 10 + 4 * k, 8 * k, rng));
  const PcmResult result = pcm({c.odom_a, c.steps_a}, {c.odom_b, c.steps_b}, loops, {0.9999, 1000000});
  EXPECT_TRUE(result.optimal);
  EXPECT_EQ(result.largest, (std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(result.second, (std::vector<std::size_t>{10, 11, 12, 13}));
  const PcmResult none = pcm({c.odom_a, c.steps_a}, {c.odom_b, c.steps_b}, {});
  EXPECT_TRUE(none.largest.empty());
}

}  // namespace
}  // namespace adit

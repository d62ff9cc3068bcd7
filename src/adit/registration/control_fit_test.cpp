// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/control_fit.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <numbers>

#include "adit/core/decompositions.hpp"
#include "adit/core/rng.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

/// In a national grid, and turned as grids are against drives.
const Pose kT_target_map = Pose(so3::exp({0.03, -0.02, 2.1}), {403'217.4, 5'719'842.9, -312.6});

Vector3 normal3(Rng& rng) { return {rng.normal(), rng.normal(), rng.normal()}; }

/// Marks at the walls along a winding tunnel of 400 m.
std::vector<Vector3> tunnel_marks(std::size_t num) {
  std::vector<Vector3> marks;
  for (std::size_t i = 0; i < num; ++i) {
    const double along = 400.0 * static_cast<double>(i) / static_cast<double>(num - 1);
    marks.emplace_back(along, 40.0 * std::sin(along / 60.0) + (i % 2 == 0 ? 2.0 : -2.0),
                       i % 3 == 0 ? 2.5 : 0.8);
  }
  return marks;
}

/// Covariance of marks in a map whose heading walks: far marks err together, sideways.
Eigen::MatrixXd drifting(const std::vector<Vector3>& marks, double heading_sigma, double mark_sigma) {
  const auto num = static_cast<Eigen::Index>(marks.size());
  Eigen::MatrixXd out = Eigen::MatrixXd::Identity(3 * num, 3 * num) * mark_sigma * mark_sigma;
  for (Eigen::Index i = 0; i < num; ++i) {
    for (Eigen::Index j = 0; j < num; ++j) {
      const double near =
          std::min(marks[static_cast<std::size_t>(i)].x(), marks[static_cast<std::size_t>(j)].x());
      const double far =
          std::max(marks[static_cast<std::size_t>(i)].x(), marks[static_cast<std::size_t>(j)].x());
      // An integral of a Wiener process, sideways and upwards.
      const double shared = heading_sigma * heading_sigma * near * near * (3.0 * far - near) / (6.0 * 400.0);
      out(3 * i + 1, 3 * j + 1) += shared;
      out(3 * i + 2, 3 * j + 2) += shared;
    }
  }
  return out;
}

ControlPairs exact_pairs(const std::vector<Vector3>& marks) {
  ControlPairs pairs;
  for (const Vector3& mark : marks) {
    pairs.names.push_back("T" + std::to_string(pairs.names.size() + 1));
    pairs.source.push_back(mark);
    pairs.target.push_back(kT_target_map * mark);
    pairs.target_sigma.emplace_back(0.01, 0.01, 0.02);
    pairs.is_check.push_back(false);
  }
  pairs.source_covariance = drifting(marks, 0.01, 0.03);
  return pairs;
}

/// With errors as stated.
ControlPairs noisy_pairs(const std::vector<Vector3>& marks, Rng& rng) {
  ControlPairs pairs = exact_pairs(marks);
  const Eigen::MatrixXd root = pairs.source_covariance.llt().matrixL();
  const Eigen::VectorXd white =
      Eigen::VectorXd::NullaryExpr(root.rows(), [&](Eigen::Index) { return rng.normal(); });
  const Eigen::VectorXd errors = root * white;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    pairs.source[i] += errors.segment<3>(3 * static_cast<Eigen::Index>(i));
    pairs.target[i] += pairs.target_sigma[i].cwiseProduct(normal3(rng));
  }
  return pairs;
}

double normalised_error(const ControlFit& fit) {
  const Vector6 error = (kT_target_map.inverse() * fit.T_target_source).log();
  return error.dot(solve_symmetric(fit.covariance, error));
}

TEST(ControlFit, ExactPointsGiveThePoseToAMicrometre) {
  const Result<ControlFit> fit = fit_control(exact_pairs(tunnel_marks(6)));
  ASSERT_TRUE(fit) << fit.error().message;
  const Vector6 error = (kT_target_map.inverse() * fit->T_target_source).log();
  EXPECT_LT(error.head<3>().norm(), 1e-6);
  EXPECT_LT(error.tail<3>().norm(), 1e-8);
  EXPECT_EQ(std::ranges::count(fit->used, true), 6);
  EXPECT_EQ(fit->redundancy, 12);
  EXPECT_NEAR(fit->chi2, 0.0, 1e-6);
  EXPECT_NEAR(fit->scale, 1.0, 1e-8);
}

// The normalised error squared has the mean 6, chi2 that of its redundancy, misfits 3, and the scale its
// sigma.
TEST(ControlFit, ItsErrorsAreAsLargeAsStated) {
  constexpr int kRuns = 300;
  Rng rng(1);
  double pose = 0.0;
  double chi2 = 0.0;
  double misfit = 0.0;
  double scale = 0.0;
  int num_misfits = 0;
  int num_rejected = 0;
  for (int run = 0; run < kRuns; ++run) {
    ControlPairs pairs = noisy_pairs(tunnel_marks(8), rng);
    pairs.is_check[3] = true;
    const Result<ControlFit> fit = fit_control(pairs);
    ASSERT_TRUE(fit) << fit.error().message;
    const auto num_used = std::ranges::count(fit->used, true);
    num_rejected += static_cast<int>(7 - num_used);
    EXPECT_FALSE(fit->used[3]);
    if (num_used < 7) continue;
    pose += normalised_error(*fit);
    chi2 += fit->chi2 / fit->redundancy;
    scale += std::pow((fit->scale - 1.0) / fit->scale_sigma, 2);
    for (const std::optional<double>& one : fit->misfits) {
      ASSERT_TRUE(one);
      misfit += *one;
      ++num_misfits;
    }
  }
  EXPECT_NEAR(pose / kRuns, 6.0, 0.7);  // the mean of 300 has a standard deviation of 0.2
  EXPECT_NEAR(chi2 / kRuns, 1.0, 0.1);
  EXPECT_NEAR(misfit / num_misfits, 3.0, 0.3);
  EXPECT_NEAR(scale / kRuns, 1.0, 0.3);
  EXPECT_LE(num_rejected, 12);  // of 2100, where the bound lets 2 be expected
}

// Up to three blunders of eight points, of 5 to 50 m, are found, and do the pose no harm.
TEST(ControlFit, BlundersAreRejectedAndNamed) {
  Rng rng(2);
  int num_missed = 0;
  double pose = 0.0;
  constexpr int kRuns = 150;
  for (int run = 0; run < kRuns; ++run) {
    ControlPairs pairs = noisy_pairs(tunnel_marks(8), rng);
    std::vector<bool> is_blunder(8, false);
    for (int b = 0; b <= run % 3; ++b) {
      const std::size_t i = rng.below(8);
      is_blunder[i] = true;
      pairs.target[i] += normal3(rng).normalized() * rng.uniform(5.0, 50.0);
    }
    const Result<ControlFit> fit = fit_control(pairs);
    ASSERT_TRUE(fit) << fit.error().message;
    for (std::size_t i = 0; i < 8; ++i)
      if (is_blunder[i]) num_missed += fit->used[i] ? 1 : 0;
    pose += normalised_error(*fit);
  }
  EXPECT_EQ(num_missed, 0);
  EXPECT_NEAR(pose / kRuns, 6.0, 1.2);
}

TEST(ControlFit, ACheckPointIsJudgedWithoutASay) {
  ControlPairs pairs = exact_pairs(tunnel_marks(6));
  const Result<ControlFit> before = fit_control(pairs);
  pairs.is_check[2] = true;
  pairs.target[2].z() += 3.0;
  const Result<ControlFit> fit = fit_control(pairs);
  ASSERT_TRUE(before && fit);
  EXPECT_LT((before->T_target_source.inverse() * fit->T_target_source).log().norm(), 1e-6);
  EXPECT_GT(fit->misfits[2].value(), kControlBound);
  EXPECT_NEAR(fit->residuals[2].z(), 3.0, 1e-5);
}

TEST(ControlFit, AStretchedGridShowsAsScale) {
  ControlPairs pairs = exact_pairs(tunnel_marks(8));
  pairs.source_covariance = drifting(pairs.source, 1e-6, 0.05);
  const Vector3 origin = pairs.target[0];
  for (Vector3& target : pairs.target) target = origin + (1.0 - 4e-4) * (target - origin);
  const Result<ControlFit> fit = fit_control(pairs);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_NEAR(fit->scale, 1.0 - 4e-4, 1e-5);
  EXPECT_LT(fit->scale_sigma, 2e-4);
}

TEST(ControlFit, ManyPointsAreSampled) {
  Rng rng(3);
  ControlPairs pairs = noisy_pairs(tunnel_marks(40), rng);
  for (const std::size_t i : {0U, 13U, 14U, 39U}) pairs.target[i].x() += 20.0;
  const Result<ControlFit> fit = fit_control(pairs);
  ASSERT_TRUE(fit) << fit.error().message;
  for (const std::size_t i : {0U, 13U, 14U, 39U}) EXPECT_FALSE(fit->used[i]);
  EXPECT_GE(std::ranges::count(fit->used, true), 35);
}

TEST(ControlFit, WhatDoesNotFixAPoseIsRefused) {
  const std::vector<Vector3> marks = tunnel_marks(6);
  EXPECT_ERROR(fit_control(exact_pairs({marks[0], marks[1]})), "2 control points, and three");
  ControlPairs with_checks = exact_pairs(marks);
  with_checks.is_check = {false, true, true, true, true, true};
  EXPECT_ERROR(fit_control(with_checks), "1 control point, and three");
  EXPECT_ERROR(fit_control(exact_pairs({{0, 0, 0}, {50, 1, 0}, {100, 2, 0}, {300, 6, 0}})), "on one line");
  EXPECT_ERROR(fit_control(exact_pairs({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}})), "on one line");
  EXPECT_ERROR(fit_control(exact_pairs({{0, 0, 0}, {100, 0.2, 0}, {200, 0, 0}})), "degrees only");
}

TEST(ControlFit, PointsThatContradictAreRefused) {
  ControlPairs pairs = exact_pairs({{0, 0, 0}, {60, 0, 0}, {30, 40, 3}});
  pairs.source_covariance = Eigen::MatrixXd::Identity(9, 9) * 1e-3;
  EXPECT_TRUE(fit_control(pairs));
  pairs.target[2].y() += 5.0;
  EXPECT_ERROR(fit_control(pairs), "no three of the control points T1, T2, T3 agree");
}

TEST(ControlFit, ExchangedAxesAreSuspected) {
  ControlPairs pairs = exact_pairs({{0, 0, 0}, {60, 0, 0}, {30, 40, 8}, {90, 20, -12}});
  pairs.source_covariance = Eigen::MatrixXd::Identity(12, 12) * 1e-3;
  for (Vector3& target : pairs.target) std::swap(target.x(), target.y());
  EXPECT_ERROR(fit_control(pairs), "with x and y exchanged they agree");
}

// Two points far apart and two beside their line: where these two disagree about the turn about that line,
// both agree with the first two.
TEST(ControlFit, TwoGroupsAreRefused) {
  ControlPairs pairs = exact_pairs({{0, 0, 0}, {100, 0, 0}, {50, 8, 0}, {50, -8, 0}});
  pairs.source_covariance = Eigen::MatrixXd::Identity(12, 12) * 1e-3;
  const Pose turned(so3::exp({0.5, 0, 0}), Vector3::Zero());
  pairs.target[3] = kT_target_map * (turned * pairs.source[3]);
  EXPECT_ERROR(fit_control(pairs), "one of T3, T4 is wrong");
}

}  // namespace
}  // namespace adit

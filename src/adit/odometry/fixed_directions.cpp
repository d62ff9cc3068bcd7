// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/fixed_directions.hpp"

#include <Eigen/Cholesky>

#include "adit/core/decompositions.hpp"

namespace adit {
namespace {

constexpr double kLever = 10.0;       // metres
constexpr double kFixedShare = 1e-6;  // of the largest eigenvalue: information below is rounding

Vector6 scales() {
  Vector6 scale = Vector6::Ones();
  scale.tail<3>().setConstant(1.0 / kLever);
  return scale;
}

}  // namespace

FixedDirections::FixedDirections(const Matrix6& information) {
  const Vector6 scale = scales();
  const auto [values, vectors] =
      symmetric_eigen(Matrix6(scale.asDiagonal() * information * scale.asDiagonal()));
  Eigen::Index num_open = 0;  // they come first
  while (num_open < 6 && !(values[num_open] > kFixedShare * values[5])) ++num_open;
  const Eigen::Index number = values[5] > 0.0 ? 6 - num_open : 0;
  basis_ = scale.asDiagonal() * vectors.rightCols(number);
  coordinates_ = vectors.rightCols(number).transpose() * scale.cwiseInverse().asDiagonal();
}

FixedDirections::Block FixedDirections::of_information(const Matrix6& information) const {
  return basis_.transpose() * information * basis_;
}

FixedDirections::Block FixedDirections::of_covariance(const Matrix6& covariance) const {
  return coordinates_ * covariance * coordinates_.transpose();
}

Matrix6 FixedDirections::information(const Block& of_fixed) const {
  return coordinates_.transpose() * of_fixed * coordinates_;
}

Matrix6 FixedDirections::covariance(const Block& of_fixed) const {
  return basis_ * of_fixed * basis_.transpose();
}

Matrix6 FixedDirections::inverse_of(const Matrix6& information) const {
  return covariance(adit::inverse(of_information(information)));
}

FixedDirections::Block inverse(const FixedDirections::Block& of_fixed) {
  return of_fixed.ldlt().solve(FixedDirections::Block::Identity(of_fixed.rows(), of_fixed.cols()));
}

Matrix6 with_sigma_at_least(const Matrix6& symmetric, double least) {
  const Vector6 inverse_scale = scales().cwiseInverse();
  const auto [values, vectors] =
      symmetric_eigen(Matrix6(inverse_scale.asDiagonal() * symmetric * inverse_scale.asDiagonal()));
  const Matrix6 V = scales().asDiagonal() * vectors;
  return V * values.cwiseMax(least * least).asDiagonal() * V.transpose();
}

}  // namespace adit

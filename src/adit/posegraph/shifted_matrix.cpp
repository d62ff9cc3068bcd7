// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "adit/core/rng.hpp"
#include "adit/posegraph/certificate_matrix.hpp"

namespace adit {
namespace {

constexpr double kRoundingMargin = 1e-12;  // of each diagonal element

// Shifts tried where S is indefinite: from this share of the mean diagonal of the rotations, each so many
// times the one before.
constexpr double kFirstShift = 1e-5;
constexpr double kShiftGrowth = 16.0;
constexpr int kMaxShifts = 7;

}  // namespace

ShiftedMatrix::ShiftedMatrix(std::vector<double> values, const BlockPattern& pattern,
                             const std::shared_ptr<const BlockSymbolic>& symbolic, std::size_t block_size)
    : values_(std::move(values)),
      pattern_(pattern),
      block_size_(block_size),
      cholesky_(symbolic, block_size) {}

template <class Visit>
void ShiftedMatrix::for_diagonal(const Visit& visit) const {
  for (std::size_t v = 0; v < pattern_.size(); ++v) {
    const std::size_t block = pattern_.column_start[v] * block_size_ * block_size_;
    for (std::size_t i = 0; i < block_size_; ++i) visit(block + i * block_size_ + i, i + 1 < block_size_);
  }
}

void ShiftedMatrix::keep_rotations(Eigen::VectorXd& x) const {
  const auto D = static_cast<Eigen::Index>(block_size_);
  for (Eigen::Index i = D - 1; i < x.size(); i += D) x(i) = 0.0;
}

double ShiftedMatrix::mean_rotation_diagonal() const {
  double sum = 0.0;
  for_diagonal([&](std::size_t at, bool is_rotation) { sum += is_rotation ? std::abs(values_[at]) : 0.0; });
  return sum / static_cast<double>(pattern_.size() * (block_size_ - 1));
}

std::optional<std::size_t> ShiftedMatrix::factorize(double shift) {
  std::vector<double> values = values_;
  for_diagonal([&](std::size_t at, bool is_rotation) {
    values[at] -= kRoundingMargin * std::abs(values[at]);
    if (is_rotation) values[at] += shift;
  });
  return cholesky_.factorize(values);
}

std::optional<double> ShiftedMatrix::factorize_with_least_shift() {
  double shift = kFirstShift * mean_rotation_diagonal();
  for (int i = 0; i < kMaxShifts; ++i, shift *= kShiftGrowth) {
    if (!factorize(shift)) return shift;
  }
  return std::nullopt;
}

Eigen::MatrixXd ShiftedMatrix::solve(const Eigen::MatrixXd& right_sides) const {
  return cholesky_.solve(right_sides);
}

ShiftedMatrix::Mode ShiftedMatrix::softest_mode(double shift, int steps) const {
  const auto n = static_cast<Eigen::Index>(pattern_.size() * block_size_);
  steps = static_cast<int>(std::min<Eigen::Index>(steps, n - static_cast<Eigen::Index>(pattern_.size())));
  Rng rng(1);
  Eigen::VectorXd q(n);
  for (double& x : q) x = rng.normal();
  keep_rotations(q);
  q.normalize();
  Eigen::MatrixXd Q(n, steps);
  Eigen::MatrixXd solved(n, steps);
  Eigen::MatrixXd T = Eigen::MatrixXd::Zero(steps, steps);
  int k = 0;
  while (true) {
    Q.col(k) = q;
    solved.col(k) = cholesky_.solve(q);
    Eigen::VectorXd next = solved.col(k);
    keep_rotations(next);
    T(k, k) = q.dot(next);
    const auto known = Q.leftCols(k + 1);
    for (int pass = 0; pass < 2; ++pass) next -= known * (known.transpose() * next).eval();
    const double beta = next.norm();
    if (++k == steps || !(beta > 1e-12 * T(0, 0))) break;
    T(k, k - 1) = T(k - 1, k) = beta;
    q = next / beta;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(T.topLeftCorner(k, k));
  return {1.0 / eigen.eigenvalues()(k - 1) - shift, solved.leftCols(k) * eigen.eigenvectors().col(k - 1)};
}

}  // namespace adit

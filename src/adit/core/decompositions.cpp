// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/decompositions.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace adit {
namespace {

template <class Values, class Matrix>
SymmetricEigen<Values, Matrix> eigen_of(const Matrix& m) {
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(m);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

}  // namespace

Svd3 svd(const Matrix3& m) {
  const Eigen::JacobiSVD<Matrix3> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

SymmetricEigen<Vector3, Matrix3> symmetric_eigen(const Matrix3& m) { return eigen_of<Vector3>(m); }
SymmetricEigen<Vector6, Matrix6> symmetric_eigen(const Matrix6& m) { return eigen_of<Vector6>(m); }

Vector6 solve_symmetric(const Matrix6& A, const Vector6& b) { return A.ldlt().solve(b); }

bool is_positive_definite(const Matrix6& m) { return m.llt().info() == Eigen::Success; }

std::optional<Matrix6> inverse_of_positive_definite(const Matrix6& m) {
  const Eigen::LLT<Matrix6> llt(m);
  if (llt.info() != Eigen::Success) return std::nullopt;
  return llt.solve(Matrix6::Identity());
}

Matrix6 inverse(const Matrix6& m) { return m.inverse(); }

}  // namespace adit

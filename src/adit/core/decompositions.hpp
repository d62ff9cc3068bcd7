// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Eigen's decompositions of the two sizes that everybody needs. Each takes seconds to compile, so that it is
/// instantiated here, once. The answers are Eigen's own, to the last bit.
#pragma once

#include <optional>

#include "adit/core/pose.hpp"

namespace adit {

/// m = u * diag(singular_values) * v^T, singular values descending.
struct Svd3 {
  Matrix3 u;                ///< Orthogonal; its determinant may be -1.
  Vector3 singular_values;  ///< None is negative.
  Matrix3 v;                ///< Orthogonal, not transposed; its determinant may be -1.
};
/// By two-sided Jacobi rotations.
[[nodiscard]] Svd3 svd(const Matrix3& m);

/// Eigenvalues ascending, eigenvectors in the columns.
template <class Values, class Vectors>
struct SymmetricEigen {
  Values values;    ///< Repeated ones as often as they occur.
  Vectors vectors;  ///< Of unit length, column i for values[i].
};
/// Only the lower triangle of `m` is read.
///@{
[[nodiscard]] SymmetricEigen<Vector3, Matrix3> symmetric_eigen(const Matrix3& m);
[[nodiscard]] SymmetricEigen<Vector6, Matrix6> symmetric_eigen(const Matrix6& m);
///@}

/// x of A x = b by LDL^T, for A symmetric and semi-definite. Not finite where A is singular.
[[nodiscard]] Vector6 solve_symmetric(const Matrix6& A, const Vector6& b);

/// Whether Cholesky's decomposition succeeds. Only the lower triangle of `m` is read.
[[nodiscard]] bool is_positive_definite(const Matrix6& m);
/// By Cholesky's decomposition; none where `m` is not positive definite.
[[nodiscard]] std::optional<Matrix6> inverse_of_positive_definite(const Matrix6& m);
/// By LU decomposition, for any regular matrix.
[[nodiscard]] Matrix6 inverse(const Matrix6& m);

}  // namespace adit

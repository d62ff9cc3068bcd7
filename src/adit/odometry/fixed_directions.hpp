// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include "adit/core/pose.hpp"

namespace adit {

/// The directions of a pose that an information matrix fixes. A perturbation x = [translation; rotation]
/// (metres, radians) within them has coordinates y, one for each: x = basis y. Inverses exist in y where they
/// do not in x. A direction is open below a millionth of the largest information, rotations by what they
/// displace 10 m away.
class FixedDirections {
 public:
  /// A matrix of y; it never takes memory from the heap.
  using Block = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 6, 6>;

  /// Those that `information` of x fixes; none where it is zero.
  explicit FixedDirections(const Matrix6& information);

  /// Of directions, 0 to 6: the length of y.
  [[nodiscard]] int number() const { return static_cast<int>(basis_.cols()); }
  /// What a matrix of x is in y (number() rows and columns), and back: zero along open directions.
  ///@{
  [[nodiscard]] Block of_information(const Matrix6& information) const;
  [[nodiscard]] Block of_covariance(const Matrix6& covariance) const;
  [[nodiscard]] Matrix6 information(const Block& of_fixed) const;
  [[nodiscard]] Matrix6 covariance(const Block& of_fixed) const;
  ///@}
  /// The inverse of an information within these directions.
  [[nodiscard]] Matrix6 inverse_of(const Matrix6& information) const;

 private:
  Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::ColMajor, 6, 6> basis_;
  Eigen::Matrix<double, Eigen::Dynamic, 6, Eigen::ColMajor, 6, 6> coordinates_;  // y of x
};

/// Of a square block that is symmetric and positive definite.
[[nodiscard]] FixedDirections::Block inverse(const FixedDirections::Block& of_fixed);

/// The nearest covariance with no standard deviation, along any direction, below `least` metres or the
/// rotation that displaces as much 10 m away. With 0: the positive part of a symmetric matrix.
[[nodiscard]] Matrix6 with_sigma_at_least(const Matrix6& symmetric, double least);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "adit/core/large_buffer.hpp"

namespace adit {

/// Which blocks of a symmetric block matrix may differ from zero: its lower triangle by columns. Each column
/// holds its diagonal first, then rows below in ascending order.
struct BlockPattern {
  std::vector<std::size_t> column_start;  ///< One more than the columns.
  std::vector<std::size_t> row;           ///< Of each block.

  [[nodiscard]] std::size_t size() const { return column_start.empty() ? 0 : column_start.size() - 1; }
  [[nodiscard]] std::size_t num_blocks() const { return row.size(); }
  /// Index of block (i, j), i >= j; it must be in the pattern.
  [[nodiscard]] std::size_t block(std::size_t i, std::size_t j) const;
  /// The pattern with all diagonal blocks and (i, j) for each pair, in any order and as often as given.
  [[nodiscard]] static BlockPattern of_pairs(std::size_t size,
                                             std::vector<std::pair<std::size_t, std::size_t>> pairs);
};

/// What depends on the pattern alone: ordering, elimination tree, supernodes. Serves every block size.
class BlockSymbolic;
[[nodiscard]] std::shared_ptr<const BlockSymbolic> analyze(const BlockPattern& pattern);
/// Multiplications and additions that one factorization needs, for block size 1.
[[nodiscard]] double factorization_work(const BlockSymbolic& symbolic);

/// Cholesky factorization of a sparse symmetric positive definite matrix of square blocks, multifrontal: each
/// supernode of the elimination tree is a dense matrix, subtrees run in parallel, and the bytes do not depend
/// on the number of threads. Ordering by approximate minimum degree on the graph of blocks. Source: Davis,
/// Rajamanickam, Sid-Lakhdar, "A survey of direct methods for sparse linear systems" (Acta Numerica 2016),
/// sections 4, 7 and 11.
class BlockCholesky {
 public:
  BlockCholesky(std::shared_ptr<const BlockSymbolic> symbolic, std::size_t block_size);

  /// `values`: the blocks in the order of the pattern, each column-major; of diagonal blocks the lower
  /// triangle counts. Returns the index of a variable (column) that the matrix leaves free: one whose pivot
  /// is not above 1e-13 of its diagonal; nothing when the matrix is positive definite. After a failure
  /// `solve` must not be called.
  [[nodiscard]] std::optional<std::size_t> factorize(const std::vector<double>& values);

  /// Solution of A X = B, one column a right side.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& right_sides) const;

 private:
  std::shared_ptr<const BlockSymbolic> symbolic_;
  std::size_t block_size_;
  LargeBuffer factor_;   // the supernodes' columns, one after another
  LargeBuffer updates_;  // room for what supernodes hand to their parents
};

}  // namespace adit

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

/// Which blocks of a symmetric block matrix may be nonzero: its lower triangle by columns. Each column holds
/// its diagonal block first, then the rows below it in ascending order.
struct BlockPattern {
  std::vector<std::size_t> column_start;  ///< First block of each column, then the number of blocks.
  std::vector<std::size_t> row;           ///< Row of each block.

  /// Block columns; as many block rows.
  [[nodiscard]] std::size_t size() const { return column_start.empty() ? 0 : column_start.size() - 1; }
  /// Blocks of the lower triangle, those on the diagonal included.
  [[nodiscard]] std::size_t num_blocks() const { return row.size(); }
  /// Index of block (i, j), i >= j, which must be in the pattern.
  [[nodiscard]] std::size_t block(std::size_t i, std::size_t j) const;
  /// The pattern with all diagonal blocks and a block for each pair (i, j). Pairs may come in any order and
  /// repeatedly.
  [[nodiscard]] static BlockPattern of_pairs(std::size_t size,
                                             std::vector<std::pair<std::size_t, std::size_t>> pairs);
};

/// The part of a factorization that depends on the pattern alone: ordering, elimination tree, supernodes.
/// Valid for every block size.
class BlockSymbolic;
/// Analyzes a pattern whose columns begin with their diagonal blocks, as `of_pairs` makes it. Ordering:
/// approximate minimum degree.
[[nodiscard]] std::shared_ptr<const BlockSymbolic> analyze(const BlockPattern& pattern);

/// Multifrontal Cholesky factorization of a sparse symmetric positive definite matrix of square blocks. Each
/// supernode of the elimination tree is a dense matrix; subtrees run in parallel; the bytes do not depend on
/// the number of threads. Ordering: approximate minimum degree on the graph of blocks. Source: Davis,
/// Rajamanickam, Sid-Lakhdar, "A survey of direct methods for sparse linear systems" (Acta Numerica 2016),
/// sections 4, 7 and 11.
///
/// A factor of floats takes half the time and memory; what it solves is right to about 1e-7 times the
/// condition number, which is enough to precondition a few rounds of conjugate gradients.
template <class Real>
class BasicBlockCholesky {
 public:
  /// Takes the memory of the factor. Blocks have `block_size` rows and columns.
  BasicBlockCholesky(std::shared_ptr<const BlockSymbolic> symbolic, std::size_t block_size);

  /// `values`: the blocks in the order of the pattern, each column-major; only the lower triangle of diagonal
  /// blocks is read. Returns nothing when the matrix is positive definite, else the index of an unconstrained
  /// variable (block column), one whose pivot is at most 1e-13 of its diagonal (floats: 1e-6);
  /// `solve` must then not be called.
  [[nodiscard]] std::optional<std::size_t> factorize(const std::vector<double>& values);

  /// Solution X of A X = B; each column of B is a right side.
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::Ref<const Eigen::MatrixXd>& right_sides) const;

  /// The smallest pivot of the latest factorization, which was that of `values`, relative to its diagonal
  /// element: how much of a variable's own information its neighbours leave, at the worst.
  [[nodiscard]] double least_pivot(const std::vector<double>& values) const;

 private:
  std::shared_ptr<const BlockSymbolic> symbolic_;
  std::size_t block_size_;
  BasicLargeBuffer<Real> factor_;   // columns of the supernodes, one after another
  BasicLargeBuffer<Real> updates_;  // workspace for what supernodes pass to their parents
};
/// In double precision.
using BlockCholesky = BasicBlockCholesky<double>;

}  // namespace adit

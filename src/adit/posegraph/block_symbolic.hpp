// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The symbolic phase of a factorization: order of elimination, tree of supernodes, and where each block of
/// the matrix goes. Private to this folder.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "adit/posegraph/block_cholesky.hpp"

namespace adit {

/// Consecutive columns of the factor with (nearly) the same rows, stored as one dense front. All sizes and
/// indices count blocks.
struct Supernode {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();  ///< No supernode.
  /// Where a block of the matrix goes in the front.
  struct Scatter {
    std::size_t block;  ///< Index in the pattern of the matrix.
    std::size_t row;  ///< Of the front, whose first `width` rows are its own columns and the others `below`.
    std::size_t column;  ///< Of the front, less than `width`.
    bool transposed;     ///< Elimination has swapped row and column, so that the block's transpose counts.
  };
  std::size_t first = 0;               ///< Columns [first, first + width) in the order of elimination.
  std::size_t width = 0;               ///< At least 1.
  std::vector<std::size_t> below;      ///< Rows under the square, ascending.
  std::vector<std::size_t> in_parent;  ///< Where each of these rows lies in the parent's front.
  std::size_t parent = kNone;          ///< The supernode that takes its update; kNone at a root.
  std::vector<std::size_t> children;   ///< Ascending.
  std::vector<Scatter> scatter;        ///< The blocks of the matrix in its columns.
  std::size_t factor_offset = 0;       ///< Where its columns start in the factor, for block size 1.
  std::size_t update_offset = 0;       ///< Where its update for the parent starts in the workspace, likewise.
  std::size_t below_offset = 0;        ///< Where its rows below start among those of all supernodes.

  /// Rows of the front.
  [[nodiscard]] std::size_t height() const { return width + below.size(); }
  /// What its elimination counts for in `BlockSymbolic::work`.
  [[nodiscard]] double work() const {
    const auto h = static_cast<double>(height());
    const auto b = static_cast<double>(below.size());
    return (h * h * h - b * b * b) / 3.0;
  }
};

/// How the order of elimination is chosen. Minimum degree is fast and causes little fill, but eliminates a
/// chain from its ends: a tree as deep as the chain is long. Nested dissection makes shallow trees.
enum class Ordering { minimum_degree, nested_dissection };

/// The part of a factorization that depends on the pattern alone; valid for every block size.
class BlockSymbolic {
 public:
  /// The last `num_last` variables of the pattern are eliminated last, so that later changes to them stay
  /// near the root.
  explicit BlockSymbolic(const BlockPattern& pattern, Ordering ordering = Ordering::minimum_degree,
                         std::size_t num_last = 0);

  std::size_t size = 0;                            ///< Variables: block columns of the pattern.
  std::size_t num_blocks = 0;                      ///< Of the pattern.
  std::vector<std::size_t> new_of_old;             ///< Position of each variable in the order of elimination.
  std::vector<std::size_t> old_of_new;             ///< The variable at each position.
  std::vector<Supernode> nodes;                    ///< Children before parents.
  std::vector<std::vector<std::size_t>> subtrees;  ///< Independent, largest first; each in order.
  std::vector<std::size_t> top;                    ///< The supernodes above all subtrees, in order.
  std::size_t factor_size = 0;                     ///< Elements of the factor, for block size 1.
  std::size_t below_size = 0;                      ///< Rows below of all supernodes together.
  std::size_t update_room = 0;  ///< Size of the workspace for all updates alive at one time, block size 1.
  double work = 0.0;            ///< Multiplications and additions of one factorization, for block size 1.

 private:
  void link_supernodes();
  void place_blocks(const BlockPattern& pattern);
  void cut_subtrees();
  void place_updates();
};

}  // namespace adit

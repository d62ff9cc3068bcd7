// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What a factorization knows before it sees a number: order of elimination, tree of supernodes, and where
/// each block of the matrix goes. Private to this folder.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "adit/posegraph/block_cholesky.hpp"

namespace adit {

/// Consecutive columns of the factor with (nearly) the same rows, held as one dense front. All in blocks.
struct Supernode {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
  /// Where a block of the matrix goes in the front.
  struct Scatter {
    std::size_t block;
    std::size_t row;
    std::size_t column;
    bool transposed;
  };
  std::size_t first = 0;  ///< Columns [first, first + width) in the order of elimination.
  std::size_t width = 0;
  std::vector<std::size_t> below;      ///< Rows under the square, ascending.
  std::vector<std::size_t> in_parent;  ///< Where each of these rows lies in the parent's front.
  std::size_t parent = kNone;
  std::vector<std::size_t> children;  ///< Ascending.
  std::vector<Scatter> scatter;
  std::size_t factor_offset = 0;  ///< Of its columns in the factor, for block size 1.
  std::size_t update_offset = 0;  ///< Of what it hands to its parent in the room for updates, the same.
  std::size_t below_offset = 0;   ///< Of its rows below in a vector of all supernodes' rows below.

  [[nodiscard]] std::size_t height() const { return width + below.size(); }
  [[nodiscard]] double work() const {
    const auto h = static_cast<double>(height());
    const auto b = static_cast<double>(below.size());
    return (h * h * h - b * b * b) / 3.0;
  }
};

/// How the order of elimination is found. Minimum degree is quick and fills little, but takes a chain from
/// its ends: a tree as deep as the chain is long. Nested dissection makes shallow trees.
enum class Ordering { minimum_degree, nested_dissection };

class BlockSymbolic {
 public:
  /// The last `num_last` variables of the pattern are eliminated last, so that what comes to them later finds
  /// them near the root.
  explicit BlockSymbolic(const BlockPattern& pattern, Ordering ordering = Ordering::minimum_degree,
                         std::size_t num_last = 0);

  std::size_t size = 0;
  std::size_t num_blocks = 0;
  std::vector<std::size_t> new_of_old;  ///< Position of each variable in the order of elimination.
  std::vector<std::size_t> old_of_new;
  std::vector<Supernode> nodes;                    ///< Children before parents.
  std::vector<std::vector<std::size_t>> subtrees;  ///< Independent, largest first; each in order.
  std::vector<std::size_t> top;                    ///< The supernodes above all subtrees, in order.
  std::size_t factor_size = 0;
  std::size_t below_size = 0;
  std::size_t update_room = 0;  ///< All updates that live at one time find room in this, for block size 1.
  double work = 0.0;

 private:
  void link_supernodes();
  void place_blocks(const BlockPattern& pattern);
  void cut_subtrees();
  void place_updates();
};

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace adit {

/// The numbers 0 to n - 1 in groups, at first each by itself, that are joined two at a time (union-find with
/// path halving). Source: Tarjan, van Leeuwen, "Worst-case analysis of set union algorithms" (JACM 1984).
class DisjointSets {
 public:
  /// `n` groups of one number each.
  explicit DisjointSets(std::size_t n) : parent_(n) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }

  /// The member that stands for the group of `i`: the same one for all of a group until the next `join`.
  [[nodiscard]] std::size_t find(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// Makes one group of two; the representative of b's group stands for it.
  void join(std::size_t a, std::size_t b) { parent_[find(a)] = find(b); }

 private:
  std::vector<std::size_t> parent_;
};

}  // namespace adit

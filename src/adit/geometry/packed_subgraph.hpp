// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "adit/geometry/bit_graph.hpp"

namespace adit {

/// The vertices of `graph` by degeneracy: repeatedly the one with fewest remaining neighbours goes last
/// (of several the smallest). Only those of core number `min_core` or more, i.e. that are in some part of the
/// graph where all have `min_core` neighbours. At most 32767 vertices.
[[nodiscard]] std::vector<std::uint32_t> degeneracy_order(const BitGraph& graph, std::size_t min_core);

/// A part of a graph, its vertices renumbered so that sets of them take few words.
class PackedSubgraph {
 public:
  /// These vertices of `graph`, in this order.
  void assign(const BitGraph& graph, std::vector<std::uint32_t> vertices);
  /// The vertices of `whole` that are in `set`, in their order there.
  void assign(const PackedSubgraph& whole, const bits::Word* set);
  /// Numbers the vertices anew, by degeneracy.
  void reorder();

  [[nodiscard]] std::size_t size() const { return names_.size(); }
  [[nodiscard]] std::size_t words() const { return words_; }
  /// What a vertex is called in the graph that all began with.
  [[nodiscard]] std::uint32_t name(std::size_t v) const { return names_[v]; }
  /// Who is not joined to v, v itself left out.
  [[nodiscard]] const bits::Word* strangers(std::size_t v) const { return strangers_.data() + v * words_; }
  /// The mean over all vertices, rounded down.
  [[nodiscard]] std::size_t mean_degree() const { return mean_degree_; }

 private:
  /// Rows `vertices_` of a table of bits, and of those the columns `vertices_`.
  void pick(const bits::Word* table, std::size_t words_per_row);
  void measure();

  std::vector<std::uint32_t> names_;
  std::size_t words_ = 0;
  std::vector<bits::Word> strangers_;
  std::size_t mean_degree_ = 0;
  std::vector<std::uint32_t> vertices_;  ///< Scratch of `assign`, as is the next.
  std::vector<std::uint32_t> by_column_;
};

}  // namespace adit

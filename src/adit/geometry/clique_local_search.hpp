// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "adit/core/rng.hpp"
#include "adit/geometry/bit_graph.hpp"

namespace adit {

/// The clique that takes, vertex by vertex, the one that leaves most to choose from. Ascending.
[[nodiscard]] std::vector<std::uint32_t> greedy_clique(const BitGraph& graph);

/// Walks from clique to clique by adding a vertex, by swapping one for another, or else by dropping one;
/// vertices that left may not come back for some steps. Starts anew when nothing larger was met for long.
/// The same walk on every machine. Source: Wu, Hao, Glover, "Multi-neighborhood tabu search for the maximum
/// weight clique problem" (2012), with all weights equal.
class CliqueLocalSearch {
 public:
  /// Starts at `clique`. The graph must outlive the search and have a vertex.
  CliqueLocalSearch(const BitGraph& graph, const std::vector<std::uint32_t>& clique);

  /// Goes on for `num_steps`; `best` is replaced by any larger clique that is met.
  void run(std::uint64_t num_steps, std::vector<std::uint32_t>& best);

 private:
  struct Tabu {
    std::size_t vertex;
    std::uint64_t until;
  };
  void clear();
  void add(std::size_t v);
  void drop(std::size_t v, std::uint64_t num_steps);
  void count_missing(std::size_t v, bool more);
  void step();
  /// Fills `choice_` with the vertices outside that miss so many neighbours inside (0 or 1) and are not
  /// tabu. Returns their number.
  std::size_t choose_from_missing(std::size_t num_missing);
  /// One of the `n` vertices of `choice_`.
  std::size_t pick(std::size_t n);

  const BitGraph& graph_;
  Rng rng_{1};
  std::vector<bits::Word> all_;
  std::vector<bits::Word> inside_;
  std::vector<bits::Word> tabu_;
  std::vector<bits::Word> choice_;
  std::vector<bits::Word> carry_;
  /// Of each vertex how many inside it is not joined to, itself not counted: plane p holds bit p of the
  /// number.
  std::vector<std::vector<bits::Word>> missing_;
  std::vector<Tabu> tabu_list_;
  std::size_t size_ = 0;
  std::size_t largest_ = 0;  ///< Since the last start.
  std::uint64_t step_ = 0;
  std::uint64_t last_gain_ = 0;
};

}  // namespace adit

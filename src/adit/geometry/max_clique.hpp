// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <vector>

#include "adit/geometry/bit_graph.hpp"

namespace adit {

/// Vertices of a graph, each two of which have an edge.
struct Clique {
  std::vector<std::uint32_t> vertices;  ///< Ascending.
  bool optimal = true;                  ///< No larger clique exists. False: the budget ran out first.
  std::uint64_t search_nodes = 0;       ///< Branches visited, and greedy cliques tried.
};

/// The largest clique, by branch and bound over bit sets. A greedy clique is the first answer; vertices that
/// no larger clique can hold (of smaller core number) are left out; the rest is searched with a greedy
/// colouring as the bound. Where that takes long, a greedy clique around each vertex comes first. Of several
/// largest cliques the first one found is returned. Decision 0021 compares this with a search four times as
/// long.
///
/// The budget is in branches, not in time, so that the same graph always has the same answer; a branch of a
/// graph of 500 vertices costs a few microseconds.
///
/// Sources: San Segundo, Rodriguez-Losada, Jimenez, "An exact bit-parallel algorithm for the maximum clique
/// problem" (2011); Tomita, Seki, "An efficient branch-and-bound algorithm for finding a maximum clique"
/// (2003); Batagelj, Zaversnik, "An O(m) algorithm for cores decomposition of networks" (2003).
[[nodiscard]] Clique max_clique(const BitGraph& graph, std::uint64_t max_search_nodes = 20'000'000);

}  // namespace adit

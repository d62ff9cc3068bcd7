// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/max_clique.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

BitGraph random_graph(std::size_t n, double density, Rng& rng) {
  BitGraph graph(n);
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = a + 1; b < n; ++b) {
      if (rng.uniform() < density) graph.add_edge(a, b);
    }
  }
  return graph;
}

bool is_clique(const BitGraph& graph, const std::vector<std::uint32_t>& vertices) {
  for (const std::uint32_t a : vertices) {
    for (const std::uint32_t b : vertices) {
      if (a != b && !graph.has_edge(a, b)) return false;
    }
  }
  return true;
}

std::size_t brute_force_size(const BitGraph& graph) {
  std::size_t best = 0;
  for (std::uint64_t set = 0; set < std::uint64_t{1} << graph.num_vertices(); ++set) {
    bool clique = true;
    for (std::size_t v = 0; v < graph.num_vertices() && clique; ++v) {
      if (((set >> v) & 1U) != 0) clique = (set & ~graph.row(v)[0]) == (std::uint64_t{1} << v);
    }
    if (clique) best = std::max(best, static_cast<std::size_t>(std::popcount(set)));
  }
  return best;
}

/// The size of the largest clique that holds `taken` and further vertices of `candidates`, by trying them
/// all.
std::size_t size_by_enumeration(const BitGraph& graph, std::size_t taken,
                                const std::vector<std::uint32_t>& candidates) {
  std::size_t best = taken;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    std::vector<std::uint32_t> joined;
    for (std::size_t j = i + 1; j < candidates.size(); ++j) {
      if (graph.has_edge(candidates[i], candidates[j])) joined.push_back(candidates[j]);
    }
    best = std::max(best, size_by_enumeration(graph, taken + 1, joined));
  }
  return best;
}

std::vector<std::uint32_t> all_of(const BitGraph& graph) {
  std::vector<std::uint32_t> vertices(graph.num_vertices());
  for (std::uint32_t v = 0; v < vertices.size(); ++v) vertices[v] = v;
  return vertices;
}

void join_all(const std::vector<std::uint32_t>& vertices, BitGraph& graph) {
  for (const std::uint32_t a : vertices) {
    for (const std::uint32_t b : vertices) {
      if (a < b) graph.add_edge(a, b);
    }
  }
}

TEST(MaxClique, EqualsBruteForce) {
  Rng rng(1);
  for (int trial = 0; trial < 60; ++trial) {
    const BitGraph graph = random_graph(1 + rng.below(13), rng.uniform(), rng);
    const Clique clique = max_clique(graph);
    EXPECT_TRUE(clique.optimal);
    EXPECT_TRUE(is_clique(graph, clique.vertices));
    EXPECT_EQ(clique.vertices.size(), brute_force_size(graph));
  }
}

/// Graphs that fill one word per row to many, and words to the last bit.
TEST(MaxClique, EqualsEnumerationOfLargerGraphs) {
  Rng rng(4);
  for (const auto& [n, density] : {std::pair{60, 0.6},
                                   {64, 0.5},
                                   {65, 0.6},
                                   {100, 0.5},
                                   {128, 0.4},
                                   {150, 0.4},
                                   {190, 0.35},
                                   {256, 0.3},
                                   {300, 0.25},
                                   {400, 0.2},
                                   {700, 0.1}}) {
    for (int trial = 0; trial < 3; ++trial) {
      const BitGraph graph = random_graph(static_cast<std::size_t>(n), density, rng);
      const Clique clique = max_clique(graph);
      EXPECT_TRUE(clique.optimal);
      EXPECT_TRUE(is_clique(graph, clique.vertices));
      EXPECT_EQ(clique.vertices.size(), size_by_enumeration(graph, 0, all_of(graph))) << n << ' ' << density;
    }
  }
}

/// A large graph of `num_groups` groups, any two vertices of different groups joined, attracts greedy
/// choices; only branch and bound sees that a few vertices beside it are all joined.
TEST(MaxClique, FindsASmallCliqueBesideALargeGraph) {
  for (const std::uint32_t num_groups : {2U, 3U, 5U, 8U}) {
    for (const std::uint32_t more : {1U, 2U, 4U}) {
      for (const std::uint32_t n : {60U, 100U, 180U, 250U, 420U}) {
        BitGraph graph(n);
        std::vector<std::uint32_t> planted;
        for (std::uint32_t k = 0; k < num_groups + more; ++k) planted.push_back(2 + 4 * k);
        for (std::uint32_t a = 0; a < n; ++a) {
          for (std::uint32_t b = 0; b < a; ++b) {
            const bool in_clique = std::ranges::count(planted, a) + std::ranges::count(planted, b) > 0;
            if (!in_clique && a % num_groups != b % num_groups) graph.add_edge(a, b);
          }
        }
        join_all(planted, graph);
        const Clique clique = max_clique(graph);
        EXPECT_TRUE(clique.optimal);
        EXPECT_EQ(clique.vertices, planted);
      }
    }
  }
}

TEST(MaxClique, FindsAPlantedCliqueAcrossWords) {
  Rng rng(2);
  BitGraph graph = random_graph(300, 0.3, rng);
  std::vector<std::uint32_t> planted;
  for (std::uint32_t k = 0; k < 25; ++k) planted.push_back(3 + 11 * k);
  join_all(planted, graph);
  EXPECT_EQ(max_clique(graph).vertices, planted);
}

TEST(MaxClique, HoldsItsBudgetAndSaysSo) {
  Rng rng(3);
  const BitGraph graph = random_graph(200, 0.9, rng);
  for (const std::uint64_t budget : {50U, 1000U, 100000U}) {
    const Clique clique = max_clique(graph, budget);
    EXPECT_FALSE(clique.optimal);
    EXPECT_EQ(clique.search_nodes, budget);
    EXPECT_TRUE(is_clique(graph, clique.vertices));
    EXPECT_GT(clique.vertices.size(), 30U);
    EXPECT_EQ(max_clique(graph, budget).vertices, clique.vertices);
  }
}

TEST(MaxClique, TakesDegenerateGraphs) {
  EXPECT_TRUE(max_clique(BitGraph(0)).vertices.empty());
  EXPECT_EQ(max_clique(BitGraph(1)).vertices.size(), 1U);
  EXPECT_EQ(max_clique(BitGraph(70)).vertices.size(), 1U);
  BitGraph complete(130);
  join_all(all_of(complete), complete);
  EXPECT_EQ(max_clique(complete, 1).vertices.size(), 130U);
}

}  // namespace
}  // namespace adit

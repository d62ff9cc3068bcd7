// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/max_clique.hpp"

#include <gtest/gtest.h>

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

bool is_clique(const BitGraph& graph, const std::vector<std::size_t>& vertices) {
  for (const std::size_t a : vertices) {
    for (const std::size_t b : vertices) {
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

TEST(MaxClique, FindsAPlantedCliqueAcrossWords) {
  Rng rng(2);
  BitGraph graph = random_graph(300, 0.3, rng);
  std::vector<std::size_t> planted;
  for (std::size_t k = 0; k < 25; ++k) planted.push_back(3 + 11 * k);
  for (const std::size_t a : planted) {
    for (const std::size_t b : planted) {
      if (a < b) graph.add_edge(a, b);
    }
  }
  EXPECT_EQ(max_clique(graph).vertices, planted);
}

TEST(MaxClique, HoldsItsBudgetAndSaysSo) {
  Rng rng(3);
  const BitGraph graph = random_graph(200, 0.9, rng);
  const Clique clique = max_clique(graph, 1000);
  EXPECT_FALSE(clique.optimal);
  EXPECT_TRUE(is_clique(graph, clique.vertices));
  EXPECT_GT(clique.vertices.size(), 20U);
  EXPECT_EQ(max_clique(graph, 1000).vertices, clique.vertices);
}

TEST(MaxClique, TakesDegenerateGraphs) {
  EXPECT_TRUE(max_clique(BitGraph(0)).vertices.empty());
  EXPECT_EQ(max_clique(BitGraph(1)).vertices.size(), 1U);
  EXPECT_EQ(max_clique(BitGraph(70)).vertices.size(), 1U);
}

}  // namespace
}  // namespace adit

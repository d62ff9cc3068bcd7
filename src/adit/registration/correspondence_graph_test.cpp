// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/correspondence_graph.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

BitGraph random_graph(std::uint64_t seed, std::size_t n, double density) {
  Rng rng(seed);
  BitGraph graph(n);
  for (std::size_t v = 0; v < n; ++v) {
    for (std::size_t w = v + 1; w < n; ++w) {
      if (rng.uniform() < density) graph.add_edge(v, w);
    }
  }
  return graph;
}

/// Removes vertices of too small degree, one k after the other, until none is left.
std::vector<std::uint32_t> core_by_brute_force(const BitGraph& graph) {
  std::vector<std::uint32_t> alive(graph.num_vertices());
  for (std::uint32_t v = 0; v < alive.size(); ++v) alive[v] = v;
  for (std::ptrdiff_t k = 1;; ++k) {
    std::vector<std::uint32_t> next = alive;
    while (true) {
      const auto degree = [&](std::uint32_t v) {
        return std::count_if(next.begin(), next.end(), [&](std::uint32_t w) { return graph.has_edge(v, w); });
      };
      const auto weak =
          std::find_if(next.begin(), next.end(), [&](std::uint32_t v) { return degree(v) < k; });
      if (weak == next.end()) break;
      next.erase(weak);
    }
    if (next.empty()) return alive;
    alive = next;
  }
}

TEST(MaxCore, AgreesWithBruteForce) {
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    const std::size_t n = 1 + seed * 3;
    const BitGraph graph = random_graph(seed, n, 0.05 + 0.02 * static_cast<double>(seed % 10));
    EXPECT_EQ(max_core(graph), core_by_brute_force(graph)) << "seed " << seed;
  }
}

TEST(MaxCore, HoldsAPlantedClique) {
  BitGraph graph = random_graph(7, 200, 0.05);
  for (std::size_t v = 30; v < 60; ++v) {
    for (std::size_t w = v + 1; w < 60; ++w) graph.add_edge(v, w);
  }
  const auto core = max_core(graph);
  for (std::uint32_t v = 30; v < 60; ++v) EXPECT_TRUE(std::binary_search(core.begin(), core.end(), v));
}

TEST(MaxCore, OfDegenerateGraphs) {
  EXPECT_TRUE(max_core(BitGraph(0)).empty());
  EXPECT_EQ(max_core(BitGraph(3)).size(), 3U);  // no edge: all are in the 0-core
}

TEST(ConsistencyGraph, JoinsWhatKeepsItsDistance) {
  Rng rng(5);
  std::vector<Eigen::Vector3f> a;
  std::vector<Eigen::Vector3f> b;
  for (int k = 0; k < 150; ++k) {  // not a multiple of the block of 64
    a.push_back(Eigen::Vector3d(rng.uniform(-5, 5), rng.uniform(-5, 5), rng.uniform(-1, 1)).cast<float>());
    b.push_back(a.back() + Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal()).cast<float>() * 0.4F);
  }
  a[20] = a[21];  // one point matched with two
  const float bound = 0.5F;
  const BitGraph graph = consistency_graph(a, b, bound);
  for (std::size_t v = 0; v < a.size(); ++v) {
    EXPECT_FALSE(graph.has_edge(v, v));
    for (std::size_t w = 0; w < a.size(); ++w) {
      EXPECT_EQ(graph.has_edge(v, w), graph.has_edge(w, v));
      const double gap = std::abs((a[v] - a[w]).cast<double>().norm() - (b[v] - b[w]).cast<double>().norm());
      if (v == w || std::abs(gap - bound) < 1e-4) continue;  // rounding decides
      EXPECT_EQ(graph.has_edge(v, w), gap < bound) << v << ' ' << w;
    }
  }
  EXPECT_EQ(consistency_graph({}, {}, bound).num_vertices(), 0U);
}

}  // namespace
}  // namespace adit

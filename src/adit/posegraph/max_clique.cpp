// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/max_clique.hpp"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

namespace adit {
namespace {

using Bits = std::vector<std::uint64_t>;

void set(Bits& bits, std::size_t i) { bits[i / 64] |= std::uint64_t{1} << (i % 64); }
void reset(Bits& bits, std::size_t i) { bits[i / 64] &= ~(std::uint64_t{1} << (i % 64)); }

void intersect(const Bits& a, const std::uint64_t* b, Bits& out) {
  for (std::size_t w = 0; w < a.size(); ++w) out[w] = a[w] & b[w];
}

// Vertices from the sparse end of the graph to its core: repeatedly the one of least remaining degree goes
// last.
std::vector<std::size_t> degeneracy_order(const BitGraph& graph) {
  const std::size_t n = graph.num_vertices();
  std::vector<std::size_t> degree(n, 0);
  for (std::size_t v = 0; v < n; ++v) {
    for (std::size_t w = 0; w < graph.words_per_row(); ++w) {
      degree[v] += static_cast<std::size_t>(std::popcount(graph.row(v)[w]));
    }
  }
  std::vector<std::size_t> order(n);
  std::vector<bool> gone(n, false);
  for (std::size_t k = n; k-- > 0;) {
    std::size_t least = n;
    for (std::size_t v = 0; v < n; ++v) {
      if (!gone[v] && (least == n || degree[v] < degree[least])) least = v;
    }
    gone[least] = true;
    order[k] = least;
    for (std::size_t v = 0; v < n; ++v) {
      if (!gone[v] && graph.has_edge(least, v)) --degree[v];
    }
  }
  return order;
}

// Branch and bound on the graph renumbered so that the densest vertices come first.
class Search {
 public:
  Search(const BitGraph& graph, std::uint64_t budget)
      : order_(degeneracy_order(graph)), rows_(graph.num_vertices()), budget_(budget) {
    const std::size_t n = graph.num_vertices();
    for (std::size_t a = 0; a < n; ++a) {
      for (std::size_t b = 0; b < n; ++b) {
        if (a != b && graph.has_edge(order_[a], order_[b])) rows_.add_edge(a, b);
      }
    }
  }

  Clique run() {
    const std::size_t n = rows_.num_vertices();
    Bits all(rows_.words_per_row(), 0);
    for (std::size_t v = 0; v < n; ++v) set(all, v);
    greedy_start(all);
    expand(all);
    Clique out{{}, !exhausted_, visited_};
    for (const std::size_t v : best_) out.vertices.push_back(order_[v]);
    std::ranges::sort(out.vertices);
    return out;
  }

 private:
  struct Coloured {
    std::size_t vertex;
    std::size_t colour;  // from 1: no clique among this vertex and those before it is larger
  };

  // From each vertex on, always the first neighbour that fits: a good clique before the search starts.
  void greedy_start(const Bits& all) {
    Bits candidates(all.size());
    for (std::size_t v = 0; v < rows_.num_vertices(); ++v) {
      std::vector<std::size_t> clique{v};
      intersect(all, rows_.row(v), candidates);
      for (std::size_t w = 0; w < candidates.size(); ++w) {
        while (candidates[w] != 0) {
          const std::size_t u = w * 64 + static_cast<std::size_t>(std::countr_zero(candidates[w]));
          clique.push_back(u);
          intersect(candidates, rows_.row(u), candidates);
        }
      }
      if (clique.size() > best_.size()) best_ = std::move(clique);
    }
  }

  // Greedy sequential colouring: each colour class is an independent set. Vertices whose colour cannot beat
  // the best clique need no branch and are left out.
  [[nodiscard]] std::vector<Coloured> colour(Bits uncoloured) const {
    std::vector<Coloured> out;
    const std::size_t needed = best_.size() >= current_.size() ? best_.size() - current_.size() : 0;
    Bits free(uncoloured.size());
    for (std::size_t colour = 1; std::ranges::any_of(uncoloured, [](std::uint64_t w) { return w != 0; });
         ++colour) {
      free = uncoloured;
      for (std::size_t w = 0; w < free.size(); ++w) {
        while (free[w] != 0) {
          const std::size_t v = w * 64 + static_cast<std::size_t>(std::countr_zero(free[w]));
          reset(uncoloured, v);
          reset(free, v);
          const std::uint64_t* row = rows_.row(v);
          for (std::size_t k = w; k < free.size(); ++k) free[k] &= ~row[k];
          if (colour > needed) out.push_back({v, colour});
        }
      }
    }
    return out;
  }

  void expand(Bits candidates) {
    if (++visited_ > budget_) {
      exhausted_ = true;
      return;
    }
    const std::vector<Coloured> branches = colour(candidates);
    Bits next(candidates.size());
    for (std::size_t i = branches.size(); i-- > 0 && !exhausted_;) {
      const auto [v, bound] = branches[i];
      if (current_.size() + bound <= best_.size()) return;
      current_.push_back(v);
      intersect(candidates, rows_.row(v), next);
      if (std::ranges::all_of(next, [](std::uint64_t w) { return w == 0; })) {
        if (current_.size() > best_.size()) best_ = current_;
      } else {
        expand(next);
      }
      current_.pop_back();
      reset(candidates, v);
    }
  }

  std::vector<std::size_t> order_;
  BitGraph rows_;
  std::uint64_t budget_;
  std::uint64_t visited_ = 0;
  bool exhausted_ = false;
  std::vector<std::size_t> current_;
  std::vector<std::size_t> best_;
};

}  // namespace

std::size_t BitGraph::num_edges() const {
  std::size_t ends = 0;
  for (const std::uint64_t word : bits_) ends += static_cast<std::size_t>(std::popcount(word));
  return ends / 2;
}

Clique max_clique(const BitGraph& graph, std::uint64_t max_search_nodes) {
  if (graph.num_vertices() == 0) return {};
  return Search(graph, max_search_nodes).run();
}

}  // namespace adit

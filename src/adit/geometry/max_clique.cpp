// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/max_clique.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace adit {
namespace {

using bits::Word;
using Vertex = std::uint32_t;
using Set = std::vector<Word>;

// Branches after which a graph counts as hard and more greedy cliques are worth their time. Graphs of
// consistent loops take fewer.
constexpr std::uint64_t kEasy = 1000;

void keep_common(Set& set, std::span<const Word> row) {
  for (std::size_t w = 0; w < set.size(); ++w) set[w] &= row[w];
}

std::size_t num_common(std::span<const Word> a, std::span<const Word> b) {
  std::size_t sum = 0;
  for (std::size_t w = 0; w < a.size(); ++w) sum += bits::count(a[w] & b[w]);
  return sum;
}

/// The clique of candidates that takes, vertex by vertex, the one with most neighbours among those that
/// remain; those joined to all others are taken at once.
std::vector<Vertex> greedy_clique(const BitGraph& graph, Set candidates) {
  std::vector<Vertex> clique;
  for (std::size_t left = bits::count(candidates); left > 0; left = bits::count(candidates)) {
    std::size_t best = 0;
    std::size_t most = 0;
    std::vector<std::size_t> joined_to_all;
    bits::for_each(candidates, [&](std::size_t v) {
      const std::size_t num = 1 + num_common(graph.row(v), candidates);
      if (num == left) joined_to_all.push_back(v);
      if (num > most) {
        most = num;
        best = v;
      }
    });
    if (joined_to_all.empty()) joined_to_all.push_back(best);
    for (const std::size_t v : joined_to_all) {
      clique.push_back(static_cast<Vertex>(v));
      bits::reset(candidates.data(), v);
      keep_common(candidates, graph.row(v));
    }
  }
  return clique;
}

/// The vertices by degeneracy: repeatedly the one with fewest remaining neighbours goes last (of several the
/// smallest). Only those of core number `min_core` or more, that is, in some part of the graph in which every
/// vertex has that many neighbours: a clique of more than `min_core` vertices is such a part.
std::vector<Vertex> degeneracy_order(const BitGraph& graph, std::size_t min_core) {
  std::vector<Vertex> rest(graph.num_vertices());
  std::iota(rest.begin(), rest.end(), Vertex{0});
  std::vector<std::size_t> degree;
  for (const Vertex v : rest) degree.push_back(bits::count(graph.row(v)));
  std::vector<Vertex> order;
  std::size_t core = 0;
  while (!rest.empty()) {
    const auto least = std::ranges::min_element(rest, {}, [&](Vertex v) { return degree[v]; });
    const Vertex v = *least;
    rest.erase(least);
    core = std::max(core, degree[v]);
    if (core >= min_core) order.push_back(v);
    bits::for_each(graph.row(v), [&](std::size_t w) { --degree[w]; });
  }
  std::ranges::reverse(order);
  return order;
}

/// These vertices of `graph` and the edges between them, numbered in the order given.
BitGraph induced(const BitGraph& graph, const std::vector<Vertex>& vertices) {
  constexpr Vertex kAbsent = std::numeric_limits<Vertex>::max();
  std::vector<Vertex> place(graph.num_vertices(), kAbsent);
  for (Vertex k = 0; k < vertices.size(); ++k) place[vertices[k]] = k;
  BitGraph part(vertices.size());
  for (Vertex k = 0; k < vertices.size(); ++k) {
    bits::for_each(graph.row(vertices[k]), [&](std::size_t v) {
      if (place[v] != kAbsent) bits::set(part.row(k).data(), place[v]);
    });
  }
  return part;
}

/// Looks for cliques of more than `size` vertices.
class Search {
 public:
  Search(const BitGraph& graph, std::size_t size, std::uint64_t budget)
      : graph_(graph), budget_(budget), best_size_(size), rest_(graph.words_per_row()), free_(rest_) {}

  void run() {
    search(std::min(kEasy, budget_));
    if (!exhausted_ || budget_ <= kEasy) return;
    exhausted_ = false;
    limit_ = budget_;
    for (std::size_t v = 0; v < graph_.num_vertices() && visit(); ++v) try_greedily_with(v);
    if (!exhausted_) search(budget_);
  }
  /// The largest clique found; empty when none is larger than `size`.
  [[nodiscard]] const std::vector<Vertex>& best() const { return best_; }
  [[nodiscard]] std::uint64_t visited() const { return visited_; }
  [[nodiscard]] bool exhausted() const { return exhausted_; }

 private:
  struct Branch {
    Vertex vertex;
    std::size_t num_colours;  ///< That suffice for this vertex and all candidates coloured before it.
  };
  struct Level {
    Set candidates;  ///< Joined to all of the path.
    std::vector<Branch> branches;
  };

  void search(std::uint64_t limit) {
    limit_ = limit;
    levels_.assign(1, {bits::first(graph_.num_vertices()), {}});
    expand();
  }

  /// Whether the limit allows for one more branch or greedy clique; counts it.
  bool visit() {
    exhausted_ = visited_ == limit_;
    visited_ += exhausted_ ? 0 : 1;
    return !exhausted_;
  }

  void try_greedily_with(std::size_t v) {
    const auto row = graph_.row(v);
    if (bits::count(row) < best_size_) return;
    std::vector<Vertex> clique = greedy_clique(graph_, {row.begin(), row.end()});
    clique.push_back(static_cast<Vertex>(v));
    if (clique.size() <= best_size_) return;
    best_size_ = clique.size();
    best_ = std::move(clique);
  }

  /// Tries each branch of the level that the path has reached, the highest colours first.
  void expand() {
    const std::size_t depth = path_.size();
    if (levels_.size() == depth + 1) levels_.push_back({Set(rest_.size()), {}});
    colour(levels_[depth], depth);
    while (!levels_[depth].branches.empty()) {
      const auto [v, num_colours] = levels_[depth].branches.back();
      levels_[depth].branches.pop_back();
      if (depth + num_colours <= best_size_) return;
      if (!visit()) return;
      take(v, depth);
      if (exhausted_) return;
    }
  }

  void take(Vertex v, std::size_t depth) {
    path_.push_back(v);
    if (path_.size() > best_size_) {
      best_ = path_;
      best_size_ = path_.size();
    }
    Set& candidates = levels_[depth].candidates;
    Set& next = levels_[depth + 1].candidates;
    const auto row = graph_.row(v);
    Word any = 0;
    for (std::size_t w = 0; w < next.size(); ++w) any |= next[w] = candidates[w] & row[w];
    bits::reset(candidates.data(), v);
    if (any != 0) expand();
    path_.pop_back();
  }

  /// Colours the candidates so that no two of a colour are joined, each colour going to the lowest vertices
  /// that it can. Those of the first colours, too few for a clique larger than the best, need no branch.
  void colour(Level& level, std::size_t depth) {
    level.branches.clear();
    const std::size_t too_few = best_size_ - depth;
    rest_ = level.candidates;
    std::size_t first = 0;  // word before which all is coloured
    for (std::size_t num_colours = 1;; ++num_colours) {
      while (first < rest_.size() && rest_[first] == 0) ++first;
      if (first == rest_.size()) return;
      const auto begin = static_cast<std::ptrdiff_t>(first);
      std::copy(rest_.begin() + begin, rest_.end(), free_.begin() + begin);
      for (std::size_t w = first; w < free_.size(); ++w) {
        while (free_[w] != 0) {
          const std::size_t v = w * bits::kWordBits + bits::lowest(free_[w]);
          const Word* row = graph_.row(v).data();
          bits::reset(rest_.data(), v);
          bits::reset(free_.data(), v);
          for (std::size_t q = w; q < free_.size(); ++q) free_[q] &= ~row[q];
          if (num_colours > too_few) level.branches.push_back({static_cast<Vertex>(v), num_colours});
        }
      }
    }
  }

  const BitGraph& graph_;
  std::uint64_t budget_;
  std::uint64_t limit_ = 0;  ///< Of the present pass: at most the budget.
  std::uint64_t visited_ = 0;
  bool exhausted_ = false;
  std::size_t best_size_;
  std::vector<Vertex> best_;
  std::vector<Vertex> path_;
  std::vector<Level> levels_;  ///< One more than the vertices of the path.
  Set rest_;                   ///< Scratch of `colour`: without a colour yet,
  Set free_;                   ///< and of these those that may take the present one.
};

}  // namespace

Clique max_clique(const BitGraph& graph, std::uint64_t max_search_nodes) {
  Clique out{greedy_clique(graph, bits::first(graph.num_vertices())), true, 0};
  const std::vector<Vertex> order = degeneracy_order(graph, out.vertices.size());
  const BitGraph part = induced(graph, order);
  Search search(part, out.vertices.size(), max_search_nodes);
  search.run();
  out.optimal = !search.exhausted();
  out.search_nodes = search.visited();
  if (!search.best().empty()) {
    out.vertices.clear();
    for (const Vertex v : search.best()) out.vertices.push_back(order[v]);
  }
  std::ranges::sort(out.vertices);
  return out;
}

}  // namespace adit

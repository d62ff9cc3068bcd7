// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The largest set of loops of which any two agree: maximum clique, against a plain bit-parallel branch and
/// bound and against igraph.
#include <igraph/igraph.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "adit/core/rng.hpp"
#include "adit/geometry/max_clique.hpp"
#include "harness/bench_case.hpp"

namespace adit::bench {
namespace {

/// BBMC as published (San Segundo, Rodriguez-Losada, Jimenez, 2011): vertices by least degree last, sets and
/// rows as bits, greedy colours as the bound, colours that cannot beat the best clique not listed. No
/// allocation while it searches.
class BitsetBranchAndBound {
 public:
  explicit BitsetBranchAndBound(const BitGraph& graph, std::uint64_t max_nodes)
      : n_(graph.num_vertices()), words_(graph.words_per_row()), nodes_left_(max_nodes) {
    const std::vector<std::size_t> order = least_degree_last(graph);
    std::vector<std::size_t> place(n_);
    for (std::size_t k = 0; k < n_; ++k) place[order[k]] = k;
    rows_.assign(n_ * words_, 0);
    for (std::size_t k = 0; k < n_; ++k) {
      bits::for_each(graph.row(order[k]), [&](std::size_t v) { bits::set(&rows_[k * words_], place[v]); });
    }
  }

  std::size_t run() {
    depths_.reserve(n_ + 1);  // levels stay where they are while deeper ones come
    depth(0).candidates = bits::first(n_);
    expand(0);
    return best_;
  }

  [[nodiscard]] bool optimal() const { return nodes_left_ > 0; }

 private:
  struct Coloured {
    std::uint32_t vertex;
    std::uint32_t colour;
  };
  struct Depth {
    std::vector<std::uint64_t> candidates;
    std::vector<Coloured> order;
  };

  static std::vector<std::size_t> least_degree_last(const BitGraph& graph) {
    const std::size_t n = graph.num_vertices();
    std::vector<std::size_t> degree(n);
    std::vector<std::size_t> rest(n);
    for (std::size_t v = 0; v < n; ++v) {
      degree[v] = bits::count(graph.row(v));
      rest[v] = v;
    }
    std::vector<std::size_t> order(n);
    for (std::size_t k = n; k-- > 0;) {
      const auto least = std::ranges::min_element(rest, {}, [&](std::size_t v) { return degree[v]; });
      order[k] = *least;
      *least = rest.back();
      rest.pop_back();
      bits::for_each(graph.row(order[k]), [&](std::size_t v) { --degree[v]; });
    }
    return order;
  }

  Depth& depth(std::size_t d) {
    while (depths_.size() <= d) {
      depths_.push_back({std::vector<std::uint64_t>(words_), std::vector<Coloured>()});
      depths_.back().order.reserve(n_);
    }
    return depths_[d];
  }

  void colour(std::size_t size, Depth& level) {
    level.order.clear();
    const std::size_t needed = best_ >= size ? best_ - size : 0;
    uncoloured_ = level.candidates;
    std::size_t first = 0;  // word before which all is coloured
    for (std::uint32_t colour = 1;; ++colour) {
      while (first < words_ && uncoloured_[first] == 0) ++first;
      if (first == words_) return;
      std::copy(uncoloured_.begin() + static_cast<std::ptrdiff_t>(first), uncoloured_.end(),
                free_.begin() + static_cast<std::ptrdiff_t>(first));
      for (std::size_t w = first; w < words_; ++w) {
        while (free_[w] != 0) {
          const std::size_t v = w * 64 + static_cast<std::size_t>(std::countr_zero(free_[w]));
          const std::uint64_t* row = &rows_[v * words_];
          uncoloured_[w] &= ~(std::uint64_t{1} << (v % 64));
          free_[w] &= free_[w] - 1;
          for (std::size_t k = w; k < words_; ++k) free_[k] &= ~row[k];
          if (colour > needed) level.order.push_back({static_cast<std::uint32_t>(v), colour});
        }
      }
    }
  }

  void expand(std::size_t size) {
    Depth& level = depth(size);
    colour(size, level);
    for (auto it = level.order.rbegin(); it != level.order.rend(); ++it) {
      if (size + it->colour <= best_) return;
      if (nodes_left_ == 0) return;
      --nodes_left_;
      Depth& next = depth(size + 1);
      const std::uint64_t* row = &rows_[it->vertex * words_];
      std::uint64_t any = 0;
      for (std::size_t w = 0; w < words_; ++w) any |= next.candidates[w] = level.candidates[w] & row[w];
      if (any != 0) {
        expand(size + 1);
      } else {
        best_ = std::max(best_, size + 1);
      }
      level.candidates[it->vertex / 64] &= ~(std::uint64_t{1} << (it->vertex % 64));
    }
  }

  std::size_t n_;
  std::size_t words_;
  std::uint64_t nodes_left_;
  std::vector<std::uint64_t> rows_;
  std::vector<std::uint64_t> uncoloured_ = std::vector<std::uint64_t>(words_);
  std::vector<std::uint64_t> free_ = std::vector<std::uint64_t>(words_);
  std::vector<Depth> depths_;
  std::size_t best_ = 0;
};

BitGraph random_graph(std::size_t n, double density, Rng& rng) {
  BitGraph graph(n);
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      if (rng.uniform() < density) graph.add_edge(a, b);
    }
  }
  return graph;
}

/// True loops, spread over the list, that all agree; false ones that agree with anything by chance.
BitGraph planted_graph(std::size_t n, double density, std::size_t size, Rng& rng) {
  BitGraph graph = random_graph(n, density, rng);
  for (std::size_t a = 0; a < size; ++a) {
    for (std::size_t b = 0; b < a; ++b) graph.add_edge(a * n / size, b * n / size);
  }
  return graph;
}

/// Loops that slid along a tunnel by anything up to 20 m: two agree when they slid nearly alike, and how near
/// that must be differs from pair to pair, as the odometry between them does. A fifth slid by less than 0.3
/// m.
BitGraph sliding_graph(std::size_t n, Rng& rng) {
  std::vector<double> slid(n);
  for (std::size_t v = 0; v < n; ++v) slid[v] = v % 5 == 0 ? rng.uniform(-0.3, 0.3) : rng.uniform(-20, 20);
  BitGraph graph(n);
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      if (std::abs(slid[a] - slid[b]) < rng.uniform(0.5, 4.0)) graph.add_edge(a, b);
    }
  }
  return graph;
}

struct CliqueCase {
  std::string name;
  std::function<BitGraph(Rng&)> graph;
  int num_graphs = 1;
  bool igraph = false;  // whether it ends within seconds
  std::uint64_t budget = 1'000'000'000;

  [[nodiscard]] std::vector<BitGraph> graphs() const {
    std::vector<BitGraph> out;
    for (int k = 0; k < num_graphs; ++k) {
      Rng rng(static_cast<std::uint64_t>(k + 1));
      out.push_back(graph(rng));
    }
    return out;
  }
};

std::vector<CliqueCase> clique_cases() {
  std::vector<CliqueCase> cases;
  const auto name = [](const char* kind, std::size_t n, double density) {
    return "clique/" + std::string(kind) + "-" + std::to_string(n) + "-" +
           std::to_string(std::lround(100 * density));
  };
  const auto random = [&](std::size_t n, double density) -> CliqueCase& {
    return cases.emplace_back(name("random", n, density),
                              [=](Rng& rng) { return random_graph(n, density, rng); });
  };
  const auto planted = [&](std::size_t n, double density, std::size_t size) -> CliqueCase& {
    return cases.emplace_back(name("planted", n, density),
                              [=](Rng& rng) { return planted_graph(n, density, size, rng); });
  };
  const auto sliding = [&](std::size_t n) -> CliqueCase& {
    return cases.emplace_back("clique/sliding-" + std::to_string(n),
                              [=](Rng& rng) { return sliding_graph(n, rng); });
  };
  const auto few = [](CliqueCase& c, int num_graphs, bool igraph = false) {
    c.num_graphs = num_graphs;
    c.igraph = igraph;
  };
  few(planted(500, 0.05, 40), 50, true);
  few(planted(500, 0.3, 40), 50);
  few(planted(500, 0.5, 40), 20);
  few(planted(1000, 0.3, 60), 20);
  few(planted(2000, 0.05, 80), 20, true);
  few(planted(2000, 0.3, 80), 3);
  planted(2000, 0.5, 80).budget = 300'000;
  few(sliding(500), 50);
  few(sliding(1000), 30);
  few(sliding(2000), 10);
  few(random(500, 0.3), 3, true);
  few(random(500, 0.5), 2);
  random(500, 0.7).budget = 1'000'000;
  random(500, 0.9).budget = 300'000;
  few(random(2000, 0.1), 4, true);
  random(2000, 0.3);
  return cases;
}

/// The mean size, and the share of graphs whose largest clique was proven to be that.
template <class Find>
Figures figures_of(const std::vector<BitGraph>& graphs, const Find& find) {
  Figures figures{{"size", 0.0}, {"proven", 0.0}};
  const auto n = static_cast<double>(graphs.size());
  for (const BitGraph& graph : graphs) {
    const auto [size, proven] = find(graph);
    figures["size"] += static_cast<double>(size) / n;
    figures["proven"] += proven ? 1.0 / n : 0.0;
  }
  return figures;
}

/// igraph's answer is Cliquer's.
class IgraphGraph {
 public:
  explicit IgraphGraph(const BitGraph& graph) {
    igraph_vector_int_t ends;
    igraph_vector_int_init(&ends, 0);
    for (std::size_t a = 0; a < graph.num_vertices(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        if (!graph.has_edge(a, b)) continue;
        igraph_vector_int_push_back(&ends, static_cast<igraph_integer_t>(a));
        igraph_vector_int_push_back(&ends, static_cast<igraph_integer_t>(b));
      }
    }
    igraph_create(&graph_, &ends, static_cast<igraph_integer_t>(graph.num_vertices()), IGRAPH_UNDIRECTED);
    igraph_vector_int_destroy(&ends);
  }
  IgraphGraph(const IgraphGraph&) = delete;
  IgraphGraph& operator=(const IgraphGraph&) = delete;
  ~IgraphGraph() { igraph_destroy(&graph_); }

  [[nodiscard]] double clique_number() const {
    igraph_integer_t size = 0;
    igraph_clique_number(&graph_, &size);
    return static_cast<double>(size);
  }

 private:
  igraph_t graph_{};
};

Work igraph_work(const std::vector<BitGraph>& graphs) {
  std::vector<std::shared_ptr<IgraphGraph>> made;
  for (const BitGraph& graph : graphs) made.push_back(std::make_shared<IgraphGraph>(graph));
  return [made] {
    Figures figures{{"size", 0.0}, {"proven", 1.0}};
    for (const auto& graph : made)
      figures["size"] += graph->clique_number() / static_cast<double>(made.size());
    return figures;
  };
}

const auto registered = [] {
  for (const CliqueCase& c : clique_cases()) {
    const bool exact = c.budget == CliqueCase{}.budget;
    const std::size_t n = c.graphs().front().num_vertices();
    Case(
        {.name = c.name,
         .work = exact ? "largest clique" : "large clique, " + std::to_string(c.budget) + " branches at most",
         .scene =
             std::to_string(c.num_graphs) + " random graphs of that kind, " + std::to_string(n) + " vertices",
         .peer = c.igraph ? "igraph" : "bitset-bnb",
         .note = "least: the table of bits read once, " + std::to_string(n * n / 8 / 1000) +
                 " kB; a branch with m candidates left colours them, m rows of m / 64 words",
         .per_run = static_cast<double>(c.num_graphs),
         .unit = "graph"});
    Side(c.name, "adit", [c] {
      return [graphs = c.graphs(), c] {
        return figures_of(graphs, [&](const BitGraph& graph) {
          const Clique clique = max_clique(graph, c.budget);
          return std::pair(clique.vertices.size(), clique.optimal);
        });
      };
    });
    Side(c.name, "bitset-bnb", [c] {
      return [graphs = c.graphs(), c] {
        return figures_of(graphs, [&](const BitGraph& graph) {
          BitsetBranchAndBound search(graph, c.budget);
          const std::size_t size = search.run();
          return std::pair(size, search.optimal());
        });
      };
    });
    if (c.igraph)
      Side(c.name, "igraph", [c] { return igraph_work(c.graphs()); },
           {.version = "igraph " IGRAPH_VERSION,
            .build = "Debian 12 package",
            .timed = "the clique number; the graph in its own form in memory"});
  }
  return 0;
}();

}  // namespace
}  // namespace adit::bench

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/correspondence_graph.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/parallel.hpp"

namespace adit {
namespace {

template <class Visit>
void for_each_bit(std::span<const std::uint64_t> words, const Visit& visit) {
  for (std::size_t w = 0; w < words.size(); ++w) {
    for (std::uint64_t bits = words[w]; bits != 0; bits &= bits - 1) {
      visit(static_cast<std::uint32_t>(w * 64 + static_cast<std::size_t>(std::countr_zero(bits))));
    }
  }
}

std::size_t num_bits(std::span<const std::uint64_t> words) {
  std::size_t sum = 0;
  for (const std::uint64_t word : words) sum += static_cast<std::size_t>(std::popcount(word));
  return sum;
}

/// Coordinates in rows, so that one correspondence meets a whole block of others in vector registers.
using Rows = Eigen::Matrix<float, 3, Eigen::Dynamic, Eigen::RowMajor>;
constexpr Eigen::Index kBlock = 64;
using BlockArray = Eigen::Array<float, 1, kBlock>;

/// Padded with NaN, which is consistent with nothing.
Rows rows_of(std::span<const Eigen::Vector3f> points) {
  const auto padded = static_cast<Eigen::Index>((points.size() + kBlock - 1) / kBlock * kBlock);
  Rows rows = Rows::Constant(3, padded, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t k = 0; k < points.size(); ++k) rows.col(static_cast<Eigen::Index>(k)) = points[k];
  return rows;
}

BlockArray squared_distances(const Rows& rows, Eigen::Index from, Eigen::Index block) {
  const auto x = rows.row(0).segment<kBlock>(block).array() - rows(0, from);
  const auto y = rows.row(1).segment<kBlock>(block).array() - rows(1, from);
  const auto z = rows.row(2).segment<kBlock>(block).array() - rows(2, from);
  return x * x + y * y + z * z;
}

std::uint64_t mask_of(const float* excess, const float* slack) {
  std::uint64_t mask = 0;
  for (unsigned k = 0; k < 64; ++k) {
    mask |= static_cast<std::uint64_t>(excess[k] <= slack[k]) << k;
  }
  return mask;
}

/// Without a square root: |da - db| <= c  <=>  s <= 0 or s^2 <= 4 da^2 db^2, with s = da^2 + db^2 - c^2.
std::uint64_t consistent_in_block(const Rows& a, const Rows& b, Eigen::Index from, Eigen::Index block,
                                  float bound) {
  const BlockArray da = squared_distances(a, from, block);
  const BlockArray db = squared_distances(b, from, block);
  const BlockArray s = (da + db - bound * bound).max(0.0F);
  const BlockArray excess = s * s;
  const BlockArray slack = 4.0F * da * db;
  return mask_of(excess.data(), slack.data());
}

using Bits = std::vector<std::uint64_t>;

Bits intersection(const Bits& bits, std::span<const std::uint64_t> row) {
  Bits out(bits.size());
  for (std::size_t w = 0; w < bits.size(); ++w) out[w] = bits[w] & row[w];
  return out;
}

void clear(Bits& bits, std::uint32_t v) { bits[v / 64] &= ~(std::uint64_t{1} << (v % 64)); }

class CliqueSearch {
 public:
  CliqueSearch(const ConsistencyGraph& graph, std::uint64_t max_nodes)
      : graph_(graph), nodes_left_(max_nodes) {}

  /// Extends the current clique by vertices of `candidates`, all of which are joined to all of it.
  void expand(Bits candidates) {
    if (current_.size() > best.size()) best = current_;
    const std::vector<Coloured> order = coloured(candidates);
    for (auto it = order.rbegin(); it != order.rend(); ++it) {
      if (current_.size() + it->colour <= best.size() || nodes_left_ == 0) return;
      --nodes_left_;
      current_.push_back(it->vertex);
      expand(intersection(candidates, graph_.row(it->vertex)));
      current_.pop_back();
      clear(candidates, it->vertex);
    }
  }

  std::vector<std::uint32_t> best;

 private:
  struct Coloured {
    std::uint32_t vertex;
    std::size_t colour;  ///< From 1; a clique has at most one vertex of each.
  };

  /// Greedy colour classes of mutually unjoined vertices, colours ascending.
  std::vector<Coloured> coloured(Bits uncoloured) const {
    std::vector<Coloured> order;
    for (std::size_t colour = 1; num_bits(uncoloured) > 0; ++colour) {
      Bits free = uncoloured;
      for_each_first(free, [&](std::uint32_t v) {
        order.push_back({v, colour});
        clear(uncoloured, v);
        const std::span<const std::uint64_t> row = graph_.row(v);
        for (std::size_t w = 0; w < free.size(); ++w) free[w] &= ~row[w];
      });
    }
    return order;
  }

  /// Takes the first bit out again and again; `visit` may clear further ones.
  template <class Visit>
  static void for_each_first(Bits& bits, const Visit& visit) {
    for (std::size_t w = 0; w < bits.size(); ++w) {
      while (bits[w] != 0) {
        const auto v =
            static_cast<std::uint32_t>(w * 64 + static_cast<std::size_t>(std::countr_zero(bits[w])));
        bits[w] &= bits[w] - 1;
        visit(v);
      }
    }
  }

  const ConsistencyGraph& graph_;
  std::uint64_t nodes_left_;
  std::vector<std::uint32_t> current_;
};

}  // namespace

void ConsistencyGraph::add_edge(std::size_t v, std::size_t w) {
  bits_[v * words_ + w / 64] |= std::uint64_t{1} << (w % 64);
  bits_[w * words_ + v / 64] |= std::uint64_t{1} << (v % 64);
}

ConsistencyGraph consistency_graph(std::span<const Eigen::Vector3f> points_a,
                                   std::span<const Eigen::Vector3f> points_b, float noise_bound) {
  ADIT_CHECK(points_a.size() == points_b.size(), "a correspondence has a point in either cloud");
  const Rows a = rows_of(points_a);
  const Rows b = rows_of(points_b);
  ConsistencyGraph graph(points_a.size());
  parallel_for_each(
      points_a.size(),
      [&](std::size_t v) {
        const std::span<std::uint64_t> row = graph.row(v);
        for (std::size_t w = 0; w < row.size(); ++w) {
          row[w] = consistent_in_block(a, b, static_cast<Eigen::Index>(v),
                                       static_cast<Eigen::Index>(w) * kBlock, noise_bound);
        }
        row[v / 64] &= ~(std::uint64_t{1} << (v % 64));  // not with itself
      },
      64);
  return graph;
}

/// Peels off the vertex of least degree again and again, vertices held in buckets by degree (Batagelj and
/// Zaversnik).
std::vector<std::uint32_t> max_core(const ConsistencyGraph& graph) {
  const std::size_t n = graph.num_vertices();
  std::vector<std::size_t> degree(n);
  std::vector<std::vector<std::uint32_t>> buckets;
  for (std::uint32_t v = 0; v < n; ++v) {
    degree[v] = num_bits(graph.row(v));
    if (degree[v] >= buckets.size()) buckets.resize(degree[v] + 1);
    buckets[degree[v]].push_back(v);
  }
  std::vector<std::size_t> core(n, 0);
  std::vector<bool> peeled(n, false);
  std::size_t k = 0;
  for (std::size_t d = 0; d < buckets.size();) {
    if (buckets[d].empty()) {
      ++d;
      continue;
    }
    const std::uint32_t v = buckets[d].back();
    buckets[d].pop_back();
    if (peeled[v] || degree[v] != d) continue;  // an entry from before its degree fell
    peeled[v] = true;
    k = std::max(k, d);
    core[v] = k;
    for_each_bit(graph.row(v), [&](std::uint32_t w) {
      if (!peeled[w] && degree[w] > d) buckets[--degree[w]].push_back(w);
    });
  }
  std::vector<std::uint32_t> innermost;
  for (std::uint32_t v = 0; v < n; ++v) {
    if (core[v] == k) innermost.push_back(v);
  }
  return innermost;
}

std::vector<std::uint32_t> largest_clique(const ConsistencyGraph& graph, std::uint64_t max_search_nodes) {
  Bits all((graph.num_vertices() + 63) / 64, 0);
  for (std::size_t v = 0; v < graph.num_vertices(); ++v) all[v / 64] |= std::uint64_t{1} << (v % 64);
  CliqueSearch search(graph, max_search_nodes);
  search.expand(std::move(all));
  std::sort(search.best.begin(), search.best.end());
  return std::move(search.best);
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Pruning of correspondences by mutual consistency: a rigid motion keeps distances, so two correct
/// correspondences (i, j) have | |a_i - a_j| - |b_i - b_j| | within the noise (ROBIN: Shi, Yang, Carlone,
/// ICRA 2021; used by KISS-Matcher, section III-D).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace adit {

/// An undirected graph as one row of bits a vertex.
class ConsistencyGraph {
 public:
  explicit ConsistencyGraph(std::size_t num_vertices)
      : num_vertices_(num_vertices), words_((num_vertices + 63) / 64), bits_(num_vertices * words_, 0) {}

  [[nodiscard]] std::size_t num_vertices() const { return num_vertices_; }
  [[nodiscard]] std::span<const std::uint64_t> row(std::size_t v) const {
    return {&bits_[v * words_], words_};
  }
  [[nodiscard]] std::span<std::uint64_t> row(std::size_t v) { return {&bits_[v * words_], words_}; }
  [[nodiscard]] bool has_edge(std::size_t v, std::size_t w) const {
    return ((row(v)[w / 64] >> (w % 64)) & 1U) != 0;
  }
  void add_edge(std::size_t v, std::size_t w);

 private:
  std::size_t num_vertices_;
  std::size_t words_;
  std::vector<std::uint64_t> bits_;
};

/// Vertex k is the correspondence of points_a[k] and points_b[k]; an edge joins two whose distances in the
/// two clouds differ by at most `noise_bound` metres. Correspondences that share a point in one cloud but not
/// nearly in the other are thereby kept apart. Throws ContractViolation when the spans differ in length.
[[nodiscard]] ConsistencyGraph consistency_graph(std::span<const Eigen::Vector3f> points_a,
                                                 std::span<const Eigen::Vector3f> points_b,
                                                 float noise_bound);

/// The vertices of the innermost k-core, ascending: the largest k such that vertices with k neighbours among
/// themselves exist (Batagelj and Zaversnik, 2003). It holds every clique of more than k vertices. Empty for
/// an empty graph.
[[nodiscard]] std::vector<std::uint32_t> max_core(const ConsistencyGraph& graph);

/// A largest clique, ascending; the largest found so far once `max_search_nodes` branches are used up: a
/// budget of branches, not of time, so that the same graph has the same answer on every machine. Branch and
/// bound with greedy colouring as the bound (Tomita and Kameda, 2007).
[[nodiscard]] std::vector<std::uint32_t> largest_clique(const ConsistencyGraph& graph,
                                                        std::uint64_t max_search_nodes);

}  // namespace adit

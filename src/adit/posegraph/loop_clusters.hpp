// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// Clusters of loops that confirm one another. Two loops agree when the cycle over both and the odometry
/// between their ends closes within its noise; loops that agree, directly or through others, form a cluster.
/// Each loop is compared with its `max_neighbours` nearest neighbours only, whose ends are at most
/// `max_steps` odometry edges away, where odometry hardly drifts and the test is sharp. A false loop agrees
/// with its neighbours only by chance, unless they repeat the same mistake: then it ends in a small cluster
/// of its own. Source: the clusters of RRR (Latif, Cadena, Neira, "Robust loop closing over time", RSS 2012),
/// section III, with the cycle test of PCM (see pcm.hpp).
struct LoopClusterConfig {
  std::size_t max_steps = 12;      ///< Odometry edges between their ends, at most.
  std::size_t max_neighbours = 8;  ///< Loops that a loop is compared with, at most.
  /// Two true neighbours pass the test this often. Low on purpose: in six dimensions the volume in which
  /// false ones agree by chance falls with the third power of the bound, and a true loop has several
  /// neighbours.
  double probability = 0.6;
  std::size_t max_piece = 10;  ///< Loops in a piece, at most.
};
/// The loops of a graph by clusters, and the clusters in pieces.
struct LoopClusters {
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);  ///< In no cluster or piece.
  std::vector<std::size_t> of_edge;  ///< Cluster of each edge; kNone for odometry.
  std::vector<std::size_t> sizes;    ///< Loops in each cluster; at least 1.
  /// Pieces of clusters, of at most `max_piece` loops: those that agree best come together first. A piece is
  /// what one mistake may have made; two pieces of one cluster agree less surely than the loops of one piece.
  std::vector<std::size_t> piece_of_edge;  ///< kNone for odometry.
  std::vector<std::size_t> piece_sizes;    ///< At least 1.
  /// chi2 that the loops of each piece cost one another, about their redundancy times `scale` for true loops
  /// and 0 for copies of one another.
  std::vector<double> piece_misfits;
  /// Variance of the measurements, loops and the odometry between them, by that which their information
  /// states: from the chi2 of the short cycles over neighbouring loops that agree, whose redundancy is known.
  /// The median cycle, raised to what it may be at 99.9 % if there are only a few. 1 where no cycle says so.
  double scale = 1.0;
};
/// Clusters the loops of a graph. The poses of its nodes do not count.
template <class P>
[[nodiscard]] LoopClusters loop_clusters(const BasicPoseGraph<P>& graph,
                                         const LoopClusterConfig& config = {});

}  // namespace adit

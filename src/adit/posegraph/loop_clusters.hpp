// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// Loops that confirm one another: two loops agree when the cycle over both and the odometry between their
/// ends closes within its noise, and loops that agree, directly or over others, form a cluster. Only
/// neighbours are compared, ends at most `max_steps` odometry edges apart, where odometry hardly drifts and
/// the test is sharp; each loop with at most `max_neighbours` of them, the nearest. A false loop agrees with
/// its neighbours by chance only, unless they copy the same mistake: then it ends in a small cluster of its
/// own. Source: the clusters of RRR (Latif, Cadena, Neira, "Robust loop closing over time", RSS 2012),
/// section III, with the cycle test of PCM (see pcm.hpp).
struct LoopClusterConfig {
  std::size_t max_steps = 12;
  std::size_t max_neighbours = 8;
  /// Two true neighbours pass the test this often. Low on purpose: in six dimensions the volume in which
  /// false ones agree by chance falls with the third power of the bound, and a true loop has several
  /// neighbours.
  double probability = 0.6;
};
struct LoopClusters {
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  std::vector<std::size_t> of_edge;  ///< Cluster of each edge; kNone for odometry. A loop alone has its own.
  std::vector<std::size_t> sizes;    ///< Loops in each cluster.
};
template <class P>
[[nodiscard]] LoopClusters loop_clusters(const BasicPoseGraph<P>& graph,
                                         const LoopClusterConfig& config = {});

}  // namespace adit

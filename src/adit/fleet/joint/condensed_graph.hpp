// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

#include "adit/posegraph/gnc.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// A graph of long odometry chains without the keyframes that nothing but odometry holds: what is between two
/// others becomes one edge, steps and covariances composed to first order.
struct CondensedGraph {
  PoseGraph graph;                ///< The edges that are not of a chain come last, in their order.
  std::vector<std::size_t> kept;  ///< Of each node its place in the whole graph, ascending.
};

/// Chains are odometry edges between nodes that follow one another in the list, each node's edge from the one
/// before it once. Chains begin with a node that no such edge ends at.
[[nodiscard]] CondensedGraph condense(const PoseGraph& whole);

/// Poses for the whole graph: those of the kept nodes, and in between odometry, the misfit at the next kept
/// node spread along the way.
[[nodiscard]] std::vector<Pose> spread(const PoseGraph& whole, const CondensedGraph& condensed,
                                       const std::vector<Pose>& poses);

/// `confirmed`: scans were compared along all loops of a pair of robots, so that many false ones do not agree
/// by chance.
enum class LoopsAre { unconfirmed, confirmed };

/// Which loops are false is found on the condensed graph, by `optimize_gnc`; the poses are the least-squares
/// solution of the whole one with the others. Of two robots of 1000 keyframes that have 20 loops, GNC then
/// sees 42 nodes instead of 2000. Where all edges fit as stated, confirmed loops all stay: GNC takes the
/// loops beyond a slip of the odometry, which strain it together, for one mistake.
[[nodiscard]] Solution<Pose> solve_robustly(const PoseGraph& whole, const GncConfig& config,
                                            LoopsAre loops = LoopsAre::unconfirmed);

}  // namespace adit

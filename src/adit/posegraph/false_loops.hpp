// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Graphs with labelled false loops, to measure how well methods find them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// Random: each false loop copies a true measurement onto a wrong pair of nodes, at least two apart.
/// Clustered: runs of ten neighbouring loops that agree with each other, as between self-similar tunnels; the
/// first of a run is random, the others follow both paths.
enum class FalseLoops { random, clustered };

/// A graph of which it is known what is true.
template <class P>
struct LabelledGraph {
  BasicPoseGraph<P> graph;   ///< Its false loops are its last edges.
  std::size_t num_true = 0;  ///< Edges known to be true, odometry included: they come first.
};

/// Adds false loops until they are `share` of all loops; the edges of `graph` stay first, in their order. A
/// graph without loops gets none. The same seed gives the same loops. Throws ContractViolation unless
/// 0 <= share < 1, or if a graph of fewer than three nodes has loops.
template <class P>
[[nodiscard]] LabelledGraph<P> with_false_loops(BasicPoseGraph<P> graph, double share, FalseLoops kind,
                                                std::uint64_t seed);

/// Removes the loops labelled false that fit `poses` with a chi2 of at most `bound`: they are true by chance.
/// Returns how many. `poses`: T_world_node, one per node, such as the optimum of the true edges.
template <class P>
std::size_t drop_true_by_chance(LabelledGraph<P>& labelled, const std::vector<P>& poses, double bound);

/// The graph with its odometry and every n-th loop, the first among them. Throws ContractViolation when n is
/// 0.
template <class P>
[[nodiscard]] BasicPoseGraph<P> with_every_nth_loop(const BasicPoseGraph<P>& graph, std::size_t n);

}  // namespace adit

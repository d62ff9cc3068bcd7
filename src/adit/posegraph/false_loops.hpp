// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Graphs that are spoiled on purpose, so that what finds false loops can be measured against labels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "adit/posegraph/pose_graph.hpp"

namespace adit {

/// Random: each copies a true measurement onto a wrong pair of nodes, at least two apart. Clustered: runs of
/// ten neighbouring loops that agree with each other, as in tunnels that look the same; the first of a run is
/// random, the others follow both paths.
enum class FalseLoops { random, clustered };

template <class P>
struct LabelledGraph {
  BasicPoseGraph<P> graph;
  std::size_t num_true = 0;  ///< Edges known to be true, odometry included: they come first.
};

/// Adds false loops until they are `share` of all loops; the edges of `graph` stay first, in their order. A
/// graph without loops gets none. The same seed gives the same loops. Throws ContractViolation unless
/// 0 <= share < 1, and when false loops are due in a graph of fewer than three nodes.
template <class P>
[[nodiscard]] LabelledGraph<P> with_false_loops(BasicPoseGraph<P> graph, double share, FalseLoops kind,
                                                std::uint64_t seed);

/// Takes the loops labelled false out again that fit `poses` with a chi2 of at most `bound`: they are true by
/// chance. Returns how many. `poses`: one a node, as of the optimum of the true edges.
template <class P>
std::size_t drop_true_by_chance(LabelledGraph<P>& labelled, const std::vector<P>& poses, double bound);

/// The graph with its odometry and every `every`-th loop, the first among them. Throws ContractViolation when
/// `every` is 0.
template <class P>
[[nodiscard]] BasicPoseGraph<P> thinned(const BasicPoseGraph<P>& graph, std::size_t every);

}  // namespace adit

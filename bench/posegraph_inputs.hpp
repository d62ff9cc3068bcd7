// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Graphs that every side of the pose-graph cases works on.
#pragma once

#include <array>
#include <string>
#include <variant>

#include "adit/posegraph/pose_graph.hpp"

namespace adit::bench {

/// A file of the shared data; cubicle's broken information matrices are repaired as peers.md says: their
/// translation-rotation blocks become zero.
[[nodiscard]] std::variant<PoseGraph, PoseGraph2> shared_graph(const std::string& name);

inline constexpr std::array kGraphNames = {"sphere2500",     "torus3D",   "cubicle",
                                           "parking-garage", "city10000", "smallGrid3D"};

/// Adds false loops until they are `share` of all loops. Random: each copies a true measurement onto a wrong
/// pair of nodes, at least two apart. Clustered: runs of ten neighbouring loops that agree with each other,
/// as in tunnels that look the same; the first of a run is random, the others follow both paths.
enum class FalseLoops { random, clustered };
/// Returns the graph and puts how many true edges it has (they come first) into `num_true`.
[[nodiscard]] PoseGraph with_false_loops(PoseGraph graph, double share, FalseLoops kind,
                                         std::size_t& num_true);

/// Every tenth loop of the graph stays.
[[nodiscard]] PoseGraph thinned(const PoseGraph& graph);

/// A robot that wanders the streets of a mine of square blocks, a keyframe a metre, with a loop at every
/// tenth keyframe that stands where one stood before. Edges in the order in which they come: each node's
/// odometry, then its loops. Poses are dead reckoning.
[[nodiscard]] PoseGraph wandering_graph(std::size_t num_keyframes);

}  // namespace adit::bench

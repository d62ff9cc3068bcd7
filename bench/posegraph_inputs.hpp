// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Graphs that every side of the pose-graph cases works on.
#pragma once

#include <array>
#include <string>
#include <variant>

#include "adit/posegraph/pose_graph.hpp"

namespace adit::bench {

/// A file of the shared data. Many information matrices of cubicle are indefinite, as their
/// translation-rotation blocks are in the wrong places; these blocks are set to zero for all sides.
[[nodiscard]] std::variant<PoseGraph, PoseGraph2> shared_graph(const std::string& name);

struct BenchGraph {
  const char* name;
  const char* size;
  const char* best_ceres;  ///< The start from which Ceres is fastest and reaches the least cost.
};
inline constexpr std::array kGraphs = {
    BenchGraph{"sphere2500", "2,500 poses, 4,949 edges", "ceres-chordal"},
    BenchGraph{"torus3D", "5,000 poses, 9,048 edges", "ceres-chordal"},
    BenchGraph{"cubicle", "5,750 poses, 16,869 edges, cross blocks of the information zeroed",
               "ceres-chordal"},
    BenchGraph{"parking-garage", "1,661 poses, 6,275 edges", "ceres"},
    BenchGraph{"city10000", "10,000 poses in the plane, 20,687 edges", "ceres"},
    BenchGraph{"smallGrid3D", "125 poses, 297 edges", "ceres-chordal"}};

/// A robot that wanders the streets of a mine of square blocks, a keyframe per metre, with a loop at every
/// tenth keyframe at a place where one has been before. Edges in the order in which they come: each node's
/// odometry, then its loops. Poses are dead reckoning.
[[nodiscard]] PoseGraph wandering_graph(std::size_t num_keyframes);

}  // namespace adit::bench

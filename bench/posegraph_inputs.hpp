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

/// A robot that wanders the streets of a mine of square blocks, a keyframe a metre, with a loop at every
/// tenth keyframe that stands where one stood before. Edges in the order in which they come: each node's
/// odometry, then its loops. Poses are dead reckoning.
[[nodiscard]] PoseGraph wandering_graph(std::size_t num_keyframes);

}  // namespace adit::bench

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// A pose graph whose every loop is true: two laps of one circle.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "adit/posegraph/pose_graph.hpp"
#include "support/graphs.hpp"

namespace adit::test {

inline constexpr double kLapSigma = 0.02;     ///< Of every measurement: metres and radians.
inline constexpr std::size_t kLapNodes = 40;  ///< Keyframes per lap, and loops in all.

/// Two laps of a circle of 10 m on a floor, keys from `first_key` on, with a loop from each keyframe of the
/// first lap to the one of the second lap at the same place.
inline PoseGraph two_laps(std::uint64_t first_key) {
  Rng rng(first_key + 1);
  PoseGraph graph;
  for (std::size_t i = 0; i < 2 * kLapNodes; ++i) {
    const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / kLapNodes;
    graph.nodes.push_back(
        {first_key + i, Pose::planar(10.0 * std::cos(angle), 10.0 * std::sin(angle), angle)});
  }
  const auto link = [&](std::size_t from, std::size_t to, EdgeKind kind) {
    graph.edges.push_back({from, to,
                           graph.nodes[from].pose.inverse() * graph.nodes[to].pose *
                               Pose::exp(random_tangent<Pose>(rng, kLapSigma)),
                           Matrix6::Identity() / (kLapSigma * kLapSigma), kind});
  };
  for (std::size_t i = 0; i + 1 < 2 * kLapNodes; ++i) link(i, i + 1, EdgeKind::odometry);
  for (std::size_t i = 0; i < kLapNodes; ++i) link(i, i + kLapNodes, EdgeKind::loop);
  return graph;
}

}  // namespace adit::test

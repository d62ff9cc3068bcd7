// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Small random graphs with known truth.
#pragma once

#include <cmath>

#include "adit/core/rng.hpp"
#include "adit/posegraph/factors.hpp"
#include "adit/posegraph/pose_graph.hpp"

namespace adit::test {

template <class P>
typename P::Tangent random_tangent(Rng& rng, double size) {
  typename P::Tangent v;
  for (double& x : v) x = size * rng.normal();
  return v;
}

/// Position with this standard deviation, any attitude.
template <class P>
P random_pose(Rng& rng, double size) {
  typename P::Tangent v = random_tangent<P>(rng, size);
  v.template tail<P::kDof == 6 ? 3 : 1>() =
      random_tangent<P>(rng, 1.0).template tail < P::kDof == 6 ? 3 : 1 > ();
  return retract(P(), v);
}

/// Positive definite, far from diagonal.
template <class P>
typename P::Jacobian random_information(Rng& rng, double size) {
  typename P::Jacobian A;
  for (double& x : A.reshaped()) x = rng.normal();
  return size * (A * A.transpose() + 0.5 * P::Jacobian::Identity());
}

/// Noise of measurements, in metres and radians on every axis.
inline constexpr double kSigma = 0.02;

/// A chain of true poses with `num_loops` chords, measurements off by noise of `sigma`, guess by dead
/// reckoning.
template <class P>
struct Made {
  BasicPoseGraph<P> graph;
  std::vector<P> truth;
};
template <class P>
Made<P> make_graph(Rng& rng, std::size_t num_nodes, std::size_t num_loops, double sigma) {
  Made<P> made;
  P pose;
  for (std::size_t i = 0; i < num_nodes; ++i) {
    made.truth.push_back(pose);
    made.graph.nodes.push_back({i, pose});
    pose = pose * retract(P(), random_tangent<P>(rng, 0.7));
  }
  const auto add = [&](std::size_t from, std::size_t to, EdgeKind kind) {
    const P Z = made.truth[from].inverse() * made.truth[to];
    made.graph.edges.push_back({from, to, retract(Z, random_tangent<P>(rng, sigma)),
                                random_information<P>(rng, sigma > 0.0 ? 1.0 / (sigma * sigma) : 1e4), kind});
  };
  for (std::size_t i = 0; i + 1 < num_nodes; ++i) add(i, i + 1, EdgeKind::odometry);
  for (std::size_t l = 0; l < num_loops; ++l) {
    const std::size_t a = rng.below(num_nodes);
    const std::size_t b = rng.below(num_nodes);
    if (a + 1 < b) add(a, b, EdgeKind::loop);
  }
  for (std::size_t i = 0; i + 1 < num_nodes; ++i) {
    made.graph.nodes[i + 1].pose = made.graph.nodes[i].pose * made.graph.edges[i].T_from_to;
  }
  return made;
}

}  // namespace adit::test

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/graph_pcm.hpp"

#include <gtest/gtest.h>

#include "adit/core/check.hpp"
#include "support/graphs.hpp"

namespace adit {
namespace {

using test::kSigma;
constexpr std::size_t kLength = 40;

// Noise of the first kind in metres, of the second in radians: an information that a wrong frame would show.
Matrix6 information() {
  Vector6 weights;
  weights << Vector3::Constant(1.0 / (kSigma * kSigma)), Vector3::Constant(1e4 / (kSigma * kSigma));
  return weights.asDiagonal();
}
Pose noise(Rng& rng) {
  Vector6 v = test::random_tangent<Pose>(rng, kSigma);
  v.tail<3>() *= 0.01;
  return Pose::exp(v);
}

struct Hall {
  PoseGraph graph;
  std::vector<Pose> truth;
};

// Two robots, each along its own row of one hall, without loops.
Hall hall(Rng& rng) {
  Hall made;
  for (std::size_t i = 0; i < 2 * kLength; ++i) {
    const auto along = static_cast<double>(i % kLength);
    made.truth.push_back(Pose::planar(along, i < kLength ? 0.0 : 8.0, 0.1 * along, std::sin(0.3 * along)));
    made.graph.nodes.push_back({i, made.truth.back()});
    if (i % kLength > 0)
      made.graph.edges.push_back({i - 1, i, made.truth[i - 1].inverse() * made.truth[i] * noise(rng),
                                  information(), EdgeKind::odometry});
  }
  return made;
}
void add_loop(Rng& rng, Hall& made, std::size_t from, std::size_t to, const Pose& error = {}) {
  made.graph.edges.push_back({from, to, made.truth[from].inverse() * made.truth[to] * error * noise(rng),
                              information(), EdgeKind::loop});
}

TEST(GraphPcm, KeepsTheTrueLoopsBetweenAndWithinRobotsWhicheverEndComesFirst) {
  Rng rng(41);
  Hall made = hall(rng);
  const std::size_t num_odometry = made.graph.edges.size();
  std::vector<double> expected(num_odometry, 1.0);
  const auto add = [&](std::size_t from, std::size_t to, bool is_true) {
    add_loop(rng, made, from, to, is_true ? Pose() : test::random_pose<Pose>(rng, 5.0));
    expected.push_back(is_true ? 1.0 : 0.0);
  };
  for (std::size_t k = 0; k < 8; ++k) {
    k % 2 == 0 ? add(4 * k, kLength + 4 * k, true) : add(kLength + 4 * k, 4 * k, true);
    add(k, 20 + 2 * k, true);
    add(3 * k, 2 * kLength - 1 - k, false);
    add(kLength - 1 - k, 2 * k, false);
  }
  const GraphPcm result = graph_pcm(made.graph, {0.9999, 1'000'000});
  EXPECT_TRUE(result.optimal);
  EXPECT_EQ(result.edge_weights, expected);
}

TEST(GraphPcm, LoopsOfDifferentPairsDoNotOutvoteEachOther) {
  // Many loops within the first robot agree; the two between the robots stand by themselves.
  Rng rng(42);
  Hall made = hall(rng);
  for (std::size_t k = 0; k < 6; ++k) add_loop(rng, made, k, 30 + k);
  add_loop(rng, made, 3, kLength + 3);
  add_loop(rng, made, 30, kLength + 30);
  const GraphPcm result = graph_pcm(made.graph, {0.9999, 1'000'000});
  EXPECT_EQ(result.edge_weights, std::vector<double>(made.graph.edges.size(), 1.0));
}

TEST(GraphPcm, NoLoopsAndSingularInformation) {
  Rng rng(43);
  Hall made = hall(rng);
  EXPECT_EQ(graph_pcm(made.graph).edge_weights, std::vector<double>(made.graph.edges.size(), 1.0));
  made.graph.edges[3].information.setZero();
  EXPECT_THROW((void)graph_pcm(made.graph), ContractViolation);
}

}  // namespace
}  // namespace adit

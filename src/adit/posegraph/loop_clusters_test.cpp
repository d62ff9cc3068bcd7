// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/loop_clusters.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "support/graphs.hpp"

namespace adit {
namespace {

using test::kSigma;

// A robot that drives the same circle twice, each lap `kLap` keyframes, with a loop from each keyframe of the
// second lap to the same place of the first.
constexpr std::size_t kLap = 40;
struct TwoLaps {
  PoseGraph graph;
  std::vector<Pose> truth;
};
Pose noise(Rng& rng, double scale) { return Pose::exp(test::random_tangent<Pose>(rng, scale * kSigma)); }

// `noise_share`: the true noise over that of the information matrices.
TwoLaps two_laps(Rng& rng, double noise_share = 1.0) {
  TwoLaps made;
  for (std::size_t i = 0; i < 2 * kLap; ++i) {
    const double angle = 2.0 * 3.14159265358979 * static_cast<double>(i) / kLap;
    made.truth.push_back(Pose::planar(10.0 * std::cos(angle), 10.0 * std::sin(angle), angle));
    made.graph.nodes.push_back({i, made.truth.back()});
  }
  const auto link = [&](std::size_t a, std::size_t b, EdgeKind kind) {
    made.graph.edges.push_back({a, b, made.truth[a].inverse() * made.truth[b] * noise(rng, noise_share),
                                Matrix6::Identity() / (kSigma * kSigma), kind});
  };
  for (std::size_t i = 0; i + 1 < 2 * kLap; ++i) link(i, i + 1, EdgeKind::odometry);
  for (std::size_t i = 0; i < kLap; ++i) link(kLap + i, i, EdgeKind::loop);
  return made;
}

// Cluster of each loop, in the order of the edges.
std::vector<std::size_t> clusters_of_loops(const PoseGraph& graph) {
  const LoopClusters clusters = loop_clusters(graph);
  std::vector<std::size_t> out;
  for (std::size_t e = 0; e < graph.edges.size(); ++e) {
    EXPECT_EQ(clusters.of_edge[e] == LoopClusters::kNone, graph.edges[e].kind == EdgeKind::odometry);
    if (clusters.of_edge[e] != LoopClusters::kNone) out.push_back(clusters.of_edge[e]);
  }
  std::size_t total = 0;
  for (const std::size_t size : clusters.sizes) total += size;
  EXPECT_EQ(total, out.size());
  return out;
}

TEST(LoopClusters, TrueLoopsFormOne) {
  Rng rng(1);
  const auto clusters = clusters_of_loops(two_laps(rng).graph);
  ASSERT_EQ(clusters.size(), kLap);
  EXPECT_EQ(std::set(clusters.begin(), clusters.end()).size(), 1U);
}

TEST(LoopClusters, FalseLoopsStayOutside) {
  // Where information overstates the noise a hundredfold, the test must sharpen by itself.
  for (const double noise_share : {1.0, 0.01}) {
    SCOPED_TRACE(noise_share);
    Rng rng(2);
    TwoLaps made = two_laps(rng, noise_share);
    const auto true_cluster = clusters_of_loops(made.graph).front();
    for (std::size_t k = 0; k < kLap; ++k) {
      const std::size_t a = rng.below(kLap);
      made.graph.edges.push_back({a, a + 10 + rng.below(kLap - 10),
                                  Pose::planar(4.0 * rng.normal(), 4.0 * rng.normal(), rng.normal()),
                                  Matrix6::Identity() / (kSigma * kSigma), EdgeKind::loop});
    }
    const auto clusters = clusters_of_loops(made.graph);
    std::size_t wrong = 0;
    for (std::size_t i = kLap; i < clusters.size(); ++i) wrong += clusters[i] == clusters.front() ? 1U : 0U;
    EXPECT_EQ(wrong, 0U) << true_cluster;
  }
}

TEST(LoopClusters, LoopsThatShareOneMistakeShareACluster) {
  Rng rng(3);
  TwoLaps made = two_laps(rng);
  // Eight loops say that keyframes 50... are where 20... are.
  for (std::size_t k = 0; k < 8; ++k) {
    made.graph.edges.push_back(
        {50 + k, 20 + k,
         made.truth[50 + k].inverse() * Pose::planar(0, 0, 0.75) * made.truth[50 + k] * noise(rng, 1.0),
         Matrix6::Identity() / (kSigma * kSigma), EdgeKind::loop});
  }
  const auto clusters = clusters_of_loops(made.graph);
  EXPECT_NE(clusters.front(), clusters.back());
}

TEST(LoopClusters, MeasureTheVarianceByShortCycles) {
  for (const double noise_share : {1.0, 0.1, 0.01}) {
    SCOPED_TRACE(noise_share);
    Rng rng(5);
    TwoLaps made = two_laps(rng, noise_share);
    const double stated = noise_share * noise_share;
    EXPECT_NEAR(std::log(loop_clusters(made.graph).scale / stated), 0.0, std::log(2.5));
    // As many false loops, in runs of copies, do not change it.
    for (std::size_t k = 0; k < kLap; ++k) {
      made.graph.edges.push_back({10 * (k / 10) + k % 10, 35 + k % 10 + k / 10,
                                  made.truth[10 * (k / 10) + k % 10].inverse() *
                                      Pose::planar(3.0 * static_cast<double>(k / 10), 1.0, 0.5) *
                                      made.truth[35 + k % 10 + k / 10],
                                  Matrix6::Identity() / (kSigma * kSigma), EdgeKind::loop});
    }
    EXPECT_NEAR(std::log(loop_clusters(made.graph).scale / stated), 0.0, std::log(4.0));
  }
}

TEST(LoopClusters, FewCyclesLeaveTheVarianceOpen) {
  Rng rng(6);
  TwoLaps made = two_laps(rng, 0.1);
  std::size_t loop = 0;
  std::erase_if(made.graph.edges,
                [&](const auto& edge) { return edge.kind == EdgeKind::loop && loop++ > 1; });
  EXPECT_GT(loop_clusters(made.graph).scale, 0.01);
  made.graph.edges.pop_back();
  EXPECT_EQ(loop_clusters(made.graph).scale, 1.0);
}

TEST(LoopClusters, PiecesAreSmallAndTheBestAgreeingComeTogether) {
  Rng rng(7);
  const TwoLaps made = two_laps(rng);
  const LoopClusters clusters = loop_clusters(made.graph);
  ASSERT_GE(clusters.piece_sizes.size(), kLap / 10);
  EXPECT_EQ(clusters.piece_sizes.size(), clusters.piece_misfits.size());
  std::vector<std::size_t> counted(clusters.piece_sizes.size(), 0);
  double misfit = 0.0;
  double redundancy = 0.0;
  for (std::size_t e = 0; e < made.graph.edges.size(); ++e)
    if (clusters.of_edge[e] != LoopClusters::kNone) ++counted.at(clusters.piece_of_edge[e]);
  EXPECT_EQ(counted, clusters.piece_sizes);
  for (std::size_t p = 0; p < counted.size(); ++p) {
    EXPECT_LE(counted[p], 10U);
    misfit += clusters.piece_misfits[p];
    redundancy += 6.0 * static_cast<double>(counted[p] - 1);
  }
  EXPECT_NEAR(misfit / (redundancy * clusters.scale), 1.0, 1e-9);
}

TEST(LoopClusters, DirectionAndOrderOfEdgesDoNotMatter) {
  Rng rng(4);
  const TwoLaps made = two_laps(rng);
  PoseGraph turned = made.graph;
  for (auto& edge : turned.edges) {
    if (edge.kind == EdgeKind::odometry || edge.from % 2 == 0) continue;
    std::swap(edge.from, edge.to);
    edge.T_from_to = edge.T_from_to.inverse();
  }
  std::ranges::reverse(turned.edges);
  auto clusters = clusters_of_loops(turned);
  std::ranges::reverse(clusters);
  const auto expected = clusters_of_loops(made.graph);
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_EQ(clusters[i] == clusters[j], expected[i] == expected[j]) << i << ' ' << j;
  }
}

TEST(LoopClusters, NothingFromNothing) {
  const LoopClusters clusters = loop_clusters(PoseGraph{});
  EXPECT_TRUE(clusters.of_edge.empty());
  EXPECT_TRUE(clusters.sizes.empty());
}

}  // namespace
}  // namespace adit

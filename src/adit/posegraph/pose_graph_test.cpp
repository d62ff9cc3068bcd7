// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/pose_graph.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

PoseGraph graph_of(std::size_t num_nodes, const std::vector<PoseGraph::Edge>& edges) {
  PoseGraph graph;
  for (std::size_t i = 0; i < num_nodes; ++i) graph.nodes.push_back({i, Pose()});
  graph.edges = edges;
  return graph;
}
PoseGraph::Edge step(std::size_t from, std::size_t to, EdgeKind kind = EdgeKind::odometry) {
  return {from, to, Pose(), Matrix6::Identity(), kind};
}
using Indices = std::vector<std::size_t>;

TEST(OdometryPaths, FollowTheStepsAndNotTheIndices) {
  // One robot drives 4 2 0, another 1 3; node 5 has a loop only.
  const auto paths =
      odometry_paths(graph_of(6, {step(2, 0), step(4, 5, EdgeKind::loop), step(1, 3), step(4, 2)}));
  ASSERT_EQ(paths.size(), 3U);
  EXPECT_EQ(paths[0].nodes, (Indices{1, 3}));
  EXPECT_EQ(paths[0].steps, (Indices{2}));
  EXPECT_EQ(paths[1].nodes, (Indices{4, 2, 0}));
  EXPECT_EQ(paths[1].steps, (Indices{3, 0}));
  EXPECT_EQ(paths[2].nodes, (Indices{5}));
  EXPECT_TRUE(paths[2].steps.empty());
}

TEST(OdometryPaths, TheFirstOfSeveralStepsCountsAndRingsAreCut) {
  const auto twice = odometry_paths(graph_of(3, {step(0, 1), step(0, 1), step(0, 2)}));
  ASSERT_EQ(twice.size(), 2U);
  EXPECT_EQ(twice[0].nodes, (Indices{0, 1}));
  EXPECT_EQ(twice[0].steps, (Indices{0}));
  const auto ring = odometry_paths(graph_of(3, {step(1, 2), step(2, 0), step(0, 1)}));
  ASSERT_EQ(ring.size(), 1U);
  EXPECT_EQ(ring[0].nodes, (Indices{0, 1, 2}));
  EXPECT_EQ(ring[0].steps, (Indices{2, 0}));
}

}  // namespace
}  // namespace adit

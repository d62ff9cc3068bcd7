// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/joint/condensed_graph.hpp"

#include <gtest/gtest.h>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr std::size_t kLength = 80;
constexpr double kSigma = 0.01;

/// Two robots drive side by side along a bend; loops tie every tenth keyframe, the last loop is false.
struct TwoChains {
  PoseGraph graph;
  std::size_t num_loops = 0;

  TwoChains() {
    Rng rng(5);
    const auto noise = [&] { return Pose::exp(kSigma * Vector6::NullaryExpr([&] { return rng.normal(); })); };
    const Matrix6 information = Matrix6::Identity() / (kSigma * kSigma);
    std::vector<Pose> truth;
    for (std::size_t r = 0; r < 2; ++r) {
      for (std::size_t k = 0; k < kLength; ++k) {
        const double s = 0.5 * static_cast<double>(k);
        truth.push_back(Pose::planar(s, static_cast<double>(r) + 0.01 * s * s, 0.02 * s));
        const bool first = graph.nodes.empty();
        if (k > 0) {
          const Pose step = truth[truth.size() - 2].inverse() * truth.back() * noise();
          graph.edges.push_back({truth.size() - 2, truth.size() - 1, step, information, EdgeKind::odometry});
          graph.nodes.push_back({truth.size() - 1, graph.nodes.back().pose * step});
        } else {
          graph.nodes.push_back({truth.size() - 1, first ? truth.back() : truth.back() * noise()});
        }
      }
    }
    for (std::size_t k = 5; k < kLength; k += 10, ++num_loops) {
      const Pose wrong = k > 70 ? Pose::planar(4.0, 0.0, 0.0) : Pose();
      graph.edges.push_back({k, kLength + k, wrong * truth[k].inverse() * truth[kLength + k] * noise(),
                             information, EdgeKind::loop});
    }
  }
};

TEST(CondensedGraph, KeepsWhatLoopsHoldAndTheEndsOfChains) {
  const TwoChains two;
  const CondensedGraph condensed = condense(two.graph);
  EXPECT_LE(condensed.kept.size(), 2 * two.num_loops + 4);
  EXPECT_TRUE(std::ranges::is_sorted(condensed.kept));
  ASSERT_GE(condensed.graph.edges.size(), two.num_loops);
  for (std::size_t l = 0; l < two.num_loops; ++l) {
    const auto& whole = two.graph.edges[two.graph.edges.size() - two.num_loops + l];
    const auto& edge = condensed.graph.edges[condensed.graph.edges.size() - two.num_loops + l];
    EXPECT_EQ(condensed.kept[edge.from], whole.from);
    EXPECT_EQ(condensed.kept[edge.to], whole.to);
  }
}

TEST(CondensedGraph, EveryPoseComesBackWhereNothingMoved) {
  const TwoChains two;
  const CondensedGraph condensed = condense(two.graph);
  const std::vector<Pose> back = spread(two.graph, condensed, poses_of(condensed.graph));
  ASSERT_EQ(back.size(), two.graph.nodes.size());
  for (std::size_t i = 0; i < back.size(); ++i)
    EXPECT_LT((back[i].inverse() * two.graph.nodes[i].pose).log().norm(), 1e-9);
}

TEST(CondensedGraph, FindsTheLoopsAndPosesThatTheWholeGraphFinds) {
  const TwoChains two;
  const Solution<Pose> whole = optimize_gnc(two.graph, {});
  const Solution<Pose> condensed = solve_robustly(two.graph, {});
  ASSERT_TRUE(whole.ok() && condensed.ok());
  EXPECT_EQ(condensed.edge_weights, whole.edge_weights);
  EXPECT_EQ(condensed.edge_weights.back(), 0.0);
  for (std::size_t i = 0; i < whole.poses.size(); ++i)
    EXPECT_LT((whole.poses[i].translation() - condensed.poses[i].translation()).norm(), 1e-3);
}

TEST(CondensedGraph, AConfirmedLoopThatIsFalseIsStillFound) {
  const TwoChains two;
  const Solution<Pose> solved = solve_robustly(two.graph, {}, LoopsAre::confirmed);
  ASSERT_TRUE(solved.ok());
  EXPECT_EQ(solved.edge_weights.back(), 0.0);
  EXPECT_EQ(std::ranges::count(solved.edge_weights, 0.0), 1);
}

}  // namespace
}  // namespace adit

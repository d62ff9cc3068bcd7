// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/false_loops.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "adit/core/check.hpp"
#include "adit/posegraph/gnc.hpp"
#include "support/graphs.hpp"

namespace adit {
namespace {

constexpr double kCentimetre = 0.01;

PoseGraph made_graph(std::uint64_t seed) {
  Rng rng(seed);
  return test::make_graph<Pose>(rng, 200, 120, kCentimetre).graph;
}
std::size_t num_loops(const PoseGraph& graph) {
  return static_cast<std::size_t>(std::ranges::count(graph.edges, EdgeKind::loop, &PoseGraph::Edge::kind));
}
bool same_ends(const PoseGraph::Edge& a, const PoseGraph::Edge& b) {
  return a.from == b.from && a.to == b.to && a.T_from_to.matrix() == b.T_from_to.matrix();
}

TEST(FalseLoops, AreTheShareThatWasAskedForAndComeLast) {
  const PoseGraph clean = made_graph(1);
  for (const FalseLoops kind : {FalseLoops::random, FalseLoops::clustered}) {
    for (const double share : {0.0, 0.1, 0.5, 0.7}) {
      const LabelledGraph<Pose> spoiled = with_false_loops(clean, share, kind, 3);
      ASSERT_EQ(spoiled.num_true, clean.edges.size());
      EXPECT_TRUE(std::ranges::equal(clean.edges.begin(), clean.edges.end(), spoiled.graph.edges.begin(),
                                     spoiled.graph.edges.begin() + static_cast<long>(spoiled.num_true),
                                     same_ends));
      const auto all = static_cast<double>(num_loops(spoiled.graph));
      const auto added = static_cast<double>(spoiled.graph.edges.size() - spoiled.num_true);
      EXPECT_NEAR(added / all, share, 1.0 / all);
      for (std::size_t e = spoiled.num_true; e < spoiled.graph.edges.size(); ++e) {
        EXPECT_EQ(spoiled.graph.edges[e].kind, EdgeKind::loop);
        EXPECT_GT(spoiled.graph.edges[e].to, spoiled.graph.edges[e].from + 1);
      }
      spoiled.graph.check();
    }
  }
}

TEST(FalseLoops, FollowTheSeed) {
  const PoseGraph clean = made_graph(2);
  const auto added = [&](std::uint64_t seed) {
    return with_false_loops(clean, 0.5, FalseLoops::random, seed).graph.edges;
  };
  EXPECT_TRUE(std::ranges::equal(added(5), added(5), same_ends));
  EXPECT_FALSE(std::ranges::equal(added(5), added(6), same_ends));
}

TEST(FalseLoops, OfAClusterAgreeWithEachOtherAndRandomOnesDoNot) {
  // The cycle over two false loops that follow one another and the odometry between their ends closes.
  const PoseGraph clean = made_graph(3);
  const auto num_closed = [&](FalseLoops kind) {
    const LabelledGraph<Pose> spoiled = with_false_loops(clean, 0.5, kind, 4);
    const auto& edges = spoiled.graph.edges;  // make_graph's odometry from i to i + 1 is edge i
    std::size_t closed = 0;
    for (std::size_t e = spoiled.num_true; e + 1 < edges.size(); ++e) {
      const auto& a = edges[e];
      const auto& b = edges[e + 1];
      if (b.from != a.from + 1 || b.to != a.to + 1) continue;
      const Pose cycle =
          a.T_from_to.inverse() * edges[a.from].T_from_to * b.T_from_to * edges[a.to].T_from_to.inverse();
      if (cycle.log().norm() < 1e-9) ++closed;
    }
    return closed;
  };
  const std::size_t num_false = num_loops(clean);
  EXPECT_GT(num_closed(FalseLoops::clustered), num_false / 2);
  EXPECT_EQ(num_closed(FalseLoops::random), 0U);
}

TEST(FalseLoops, ThatAreTrueByChanceAreTakenOut) {
  const PoseGraph clean = made_graph(4);
  LabelledGraph<Pose> spoiled = with_false_loops(clean, 0.3, FalseLoops::random, 7);
  const std::size_t num_false = spoiled.graph.edges.size() - spoiled.num_true;
  const std::vector<Pose> optimum = optimize(clean).poses;
  auto lucky = spoiled.graph.edges.back();
  lucky.T_from_to = optimum[lucky.from].inverse() * optimum[lucky.to];
  spoiled.graph.edges.insert(spoiled.graph.edges.begin() + static_cast<long>(spoiled.num_true), lucky);
  EXPECT_EQ(drop_true_by_chance(spoiled, optimum, chi2_quantile(0.999, 6)), 1U);
  EXPECT_EQ(spoiled.graph.edges.size() - spoiled.num_true, num_false);
  EXPECT_FALSE(same_ends(spoiled.graph.edges[spoiled.num_true], lucky));
}

TEST(FalseLoops, NeedAShareBelowOneAndRoom) {
  const PoseGraph clean = made_graph(5);
  EXPECT_THROW((void)with_false_loops(clean, 1.0, FalseLoops::random, 1), ContractViolation);
  EXPECT_THROW((void)with_false_loops(clean, -0.1, FalseLoops::random, 1), ContractViolation);
  PoseGraph pair{{{0, Pose()}, {1, Pose()}},
                 {{0, 1, Pose(), Matrix6::Identity(), EdgeKind::odometry},
                  {0, 1, Pose(), Matrix6::Identity(), EdgeKind::loop}}};
  EXPECT_THROW((void)with_false_loops(pair, 0.5, FalseLoops::random, 1), ContractViolation);
  pair.edges.pop_back();
  EXPECT_EQ(with_false_loops(pair, 0.5, FalseLoops::random, 1).graph.edges.size(), 1U);
}

TEST(Thinned, KeepsOdometryAndEveryNthLoop) {
  const PoseGraph clean = made_graph(6);
  const PoseGraph thin = with_every_nth_loop(clean, 10);
  EXPECT_EQ(num_loops(thin), (num_loops(clean) + 9) / 10);
  EXPECT_EQ(thin.edges.size() - num_loops(thin), clean.edges.size() - num_loops(clean));
  EXPECT_TRUE(std::ranges::equal(with_every_nth_loop(clean, 1).edges, clean.edges, same_ends));
  EXPECT_THROW((void)with_every_nth_loop(clean, 0), ContractViolation);
}

}  // namespace
}  // namespace adit

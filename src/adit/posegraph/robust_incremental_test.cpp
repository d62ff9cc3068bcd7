// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/robust_incremental.hpp"

#include <gtest/gtest.h>

#include "adit/posegraph/false_loops.hpp"
#include "adit/posegraph/gnc.hpp"
#include "support/graphs.hpp"

namespace adit {
namespace {

template <class P>
class RobustIncrementalOf : public testing::Test {};
using Spaces = testing::Types<Pose, Pose2>;
TYPED_TEST_SUITE(RobustIncrementalOf, Spaces);

template <class P>
struct Fed {
  RobustIncremental<P> solver;
  std::vector<std::size_t> edge_of;  // of the graph, by that of the solver
  std::size_t num_false_ever = 0;    // loops in use that are false, at the worst step
};
/// Feeds nodes in their order, each with all edges to nodes before it.
template <class P>
Fed<P> fed(const LabelledGraph<P>& labelled) {
  Fed<P> out;
  const auto& graph = labelled.graph;
  out.solver.add_node(0, graph.nodes.front().pose);
  std::size_t num_false = 0;
  for (std::size_t i = 1; i < graph.nodes.size(); ++i) {
    out.solver.add_node(i, out.solver.poses().back() * graph.edges[i - 1].T_from_to);
    for (std::size_t e = 0; e < graph.edges.size(); ++e) {
      if (std::max(graph.edges[e].from, graph.edges[e].to) != i) continue;
      out.edge_of.push_back(e);
      EXPECT_EQ(out.solver.add_edge(graph.edges[e]) + 1, out.edge_of.size());
    }
    const auto step = out.solver.update();
    EXPECT_TRUE(step.status == SolveStatus::converged || step.status == SolveStatus::max_iterations)
        << step.reason;
    for (const std::size_t e : step.accepted) num_false += out.edge_of[e] >= labelled.num_true ? 1 : 0;
    for (const std::size_t e : step.dropped) num_false -= out.edge_of[e] >= labelled.num_true ? 1 : 0;
    out.num_false_ever = std::max(out.num_false_ever, num_false);
  }
  return out;
}

template <class P>
LabelledGraph<P> spoiled_graph() {
  Rng rng(21);
  // Steps of 0.7 m: the map is of metres, so that loops are evidence only where predictions are sharp.
  const auto made = test::make_graph<P>(rng, 150, 60, 0.005);
  auto labelled = with_false_loops(made.graph, 0.5, FalseLoops::random, 22);
  drop_true_by_chance(labelled, optimize(made.graph).poses, chi2_quantile(0.999, P::kDof));
  return labelled;
}

TYPED_TEST(RobustIncrementalOf, FindsFalseLoopsAtEveryStep) {
  using P = TypeParam;
  const LabelledGraph<P> labelled = spoiled_graph<P>();
  const Fed<P> result = fed(labelled);
  EXPECT_EQ(result.num_false_ever, 0U);
  std::size_t num_true = 0;
  std::size_t num_kept = 0;
  for (std::size_t e = 0; e < result.edge_of.size(); ++e) {
    if (result.solver.graph().edges[e].kind != EdgeKind::loop || result.edge_of[e] >= labelled.num_true)
      continue;
    ++num_true;
    num_kept += result.solver.is_in_use(e) ? 1 : 0;
  }
  EXPECT_GE(num_true, 20U);
  EXPECT_GE(100 * num_kept, 95 * num_true);
  // The map is that of the true edges; false loops would bend it by metres.
  BasicPoseGraph<P> clean = labelled.graph;
  clean.edges.resize(labelled.num_true);
  const Solution<P> batch = optimize(clean);
  for (std::size_t i = 0; i < batch.poses.size(); ++i)
    EXPECT_LT((batch.poses[i].translation() - result.solver.poses()[i].translation()).norm(), 0.3);
}

TYPED_TEST(RobustIncrementalOf, GivesTheSameBytesTwice) {
  using P = TypeParam;
  const LabelledGraph<P> labelled = spoiled_graph<P>();
  const Fed<P> first = fed(labelled);
  const Fed<P> second = fed(labelled);
  for (std::size_t i = 0; i < labelled.graph.nodes.size(); ++i)
    EXPECT_EQ(first.solver.poses()[i].translation(), second.solver.poses()[i].translation());
}

/// A drive out and back on a parallel line, whose heading is so uncertain that one loop at its end proves
/// nothing.
PoseGraph2 out_and_back() {
  PoseGraph2 graph;
  const Matrix3 information = Eigen::Vector3d(100.0, 100.0, 25.0).asDiagonal();
  graph.nodes.push_back({0, Pose2()});
  for (std::size_t i = 1; i < 60; ++i) {
    const Pose2 step(1.0, 0.0, i == 30 || i == 31 ? std::acos(-1.0) / 2.0 : 0.0);
    graph.edges.push_back({i - 1, i, step, information, EdgeKind::odometry});
    graph.nodes.push_back({i, graph.nodes.back().pose * step});
  }
  return graph;
}

TEST(RobustIncremental, OneLoopWaitsUntilAnotherConfirmsIt) {
  LabelledGraph<Pose2> labelled{out_and_back(), 0};
  const auto& nodes = labelled.graph.nodes;
  const Matrix3 sharp = Eigen::Vector3d(1e4, 1e4, 1e4).asDiagonal();
  std::vector<Pose2> truth = poses_of(labelled.graph);
  for (const std::size_t to : {std::size_t{58}, std::size_t{59}})
    labelled.graph.edges.push_back(
        {60 - to, to, truth[60 - to].inverse() * truth[to], sharp, EdgeKind::loop});
  labelled.num_true = labelled.graph.edges.size();
  RobustIncremental<Pose2> solver;
  solver.add_node(0, Pose2());
  for (std::size_t i = 1; i < nodes.size(); ++i) {
    solver.add_node(i, solver.poses().back() * labelled.graph.edges[i - 1].T_from_to);
    solver.add_edge(labelled.graph.edges[i - 1]);
    if (i >= 58) solver.add_edge(labelled.graph.edges[i + 1]);
    const auto step = solver.update();
    EXPECT_EQ(step.accepted.size(), i == 59 ? 2U : 0U) << i;
    EXPECT_EQ(step.num_waiting, i == 58 ? 1U : 0U) << i;
  }
}

}  // namespace
}  // namespace adit

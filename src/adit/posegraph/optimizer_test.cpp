// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/optimizer.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

#include "adit/core/check.hpp"
#include "adit/core/parallel.hpp"
#include "adit/posegraph/chordal.hpp"
#include "adit/posegraph/marginals.hpp"
#include "support/graphs.hpp"

namespace adit {
namespace {

template <class P>
double cost_at(const BasicPoseGraph<P>& graph, const std::vector<P>& poses) {
  double sum = 0.0;
  for (const double cost : edge_costs(graph, poses)) sum += cost;
  return sum;
}

// Dense normal equations with node 0 held, all derivatives of the stacked residual taken from `linearize`.
template <class P>
Eigen::MatrixXd dense_hessian(const BasicPoseGraph<P>& graph, const std::vector<P>& poses,
                              Eigen::VectorXd& gradient) {
  constexpr int D = P::kDof;
  const auto at = [](std::size_t i) { return static_cast<Eigen::Index>(i) * D; };
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(at(poses.size()), at(poses.size()));
  gradient = Eigen::VectorXd::Zero(at(poses.size()));
  for (const auto& edge : graph.edges) {
    const auto f = linearize(edge.T_from_to, poses[edge.from], poses[edge.to]);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(D, H.cols());
    J.middleCols(at(edge.from), D) = f.d_from;
    J.middleCols(at(edge.to), D) = f.d_to;
    H += J.transpose() * edge.information * J;
    gradient += J.transpose() * edge.information * f.residual;
  }
  const Eigen::Index n = H.cols() - D;
  gradient = gradient.tail(n).eval();
  return H.bottomRightCorner(n, n);
}

template <class P>
std::vector<P> dense_gauss_newton(const BasicPoseGraph<P>& graph) {
  std::vector<P> poses = poses_of(graph);
  for (int iteration = 0; iteration < 50; ++iteration) {
    Eigen::VectorXd g;
    const Eigen::MatrixXd H = dense_hessian(graph, poses, g);
    const Eigen::VectorXd step = -H.llt().solve(g);
    for (std::size_t i = 1; i < poses.size(); ++i) {
      poses[i] = retract(
          poses[i], typename P::Tangent(step.segment<P::kDof>(static_cast<Eigen::Index>(i - 1) * P::kDof)));
    }
  }
  return poses;
}

template <class P>
void expect_same_minimum_as_dense() {
  Rng rng(11);
  for (const std::size_t n : {2U, 3U, 12U, 25U}) {
    const auto made = test::make_graph<P>(rng, n, n, 0.02);
    const std::vector<P> dense = dense_gauss_newton(made.graph);
    for (const SolveMethod method : kSolveMethods) {
      OptimizerConfig config;
      config.method = method;
      config.relative_tolerance = 1e-14;
      const auto solution = optimize(made.graph, config);
      ASSERT_EQ(solution.status, SolveStatus::converged) << solution.reason;
      EXPECT_NEAR(solution.cost_final, cost_at(made.graph, dense), 1e-9 * (1.0 + solution.cost_final));
      for (std::size_t i = 0; i < n; ++i) {
        EXPECT_LT(between_residual(P(), solution.poses[i], dense[i]).norm(), 1e-6);
      }
    }
  }
}
TEST(Optimizer, FindsTheMinimumOfDenseGaussNewtonInSpace) { expect_same_minimum_as_dense<Pose>(); }
TEST(Optimizer, FindsTheMinimumOfDenseGaussNewtonInThePlane) { expect_same_minimum_as_dense<Pose2>(); }

// From random poses many steps gain far less than their model predicts, and the shorter a step is damped the
// less it gains: neither shows a minimum.
template <class P>
void expect_nothing_left_to_gain(double initial_damping) {
  int num_judged = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    Rng rng(seed);
    auto graph = test::make_graph<P>(rng, 12, 12, 0.05).graph;
    for (std::size_t i = 1; i < graph.nodes.size(); ++i) graph.nodes[i].pose = test::random_pose<P>(rng, 3.0);
    OptimizerConfig config;
    config.initialization = SolveStart::given;
    config.initial_damping = initial_damping;
    config.max_iterations = 1000;
    const auto solution = optimize(graph, config);
    ASSERT_EQ(solution.status, SolveStatus::converged) << solution.reason;
    // Where some residual is half a turn the cost has a kink, in which a search may end rightly.
    const bool in_kink = std::ranges::any_of(graph.edges, [&](const auto& edge) {
      const auto r = between_residual(edge.T_from_to, solution.poses[edge.from], solution.poses[edge.to]);
      return r.template tail < P::kDof == 6 ? 3 : 1 > ().norm() > 3.1;
    });
    if (in_kink) continue;
    ++num_judged;
    Eigen::VectorXd g;
    const Eigen::MatrixXd H = dense_hessian(graph, solution.poses, g);
    const double to_gain = g.dot(H.llt().solve(g));
    EXPECT_LT(to_gain, 10.0 * config.relative_tolerance * solution.cost_final + 1e-12) << seed;
  }
  EXPECT_GT(num_judged, 20);
}
TEST(Optimizer, EndsWhereTheModelHasNothingLeftToGain) {
  for (const double initial_damping : {0.0, 1.0, 1e6}) {
    expect_nothing_left_to_gain<Pose>(initial_damping);
    expect_nothing_left_to_gain<Pose2>(initial_damping);
  }
}

TEST(Optimizer, AveragesTwoMeasurementsOfOneEdgeByTheirInformation) {
  PoseGraph graph;
  graph.nodes = {{5, Pose()}, {9, Pose::translation_of(7.0, 0.0, 0.0)}};
  graph.edges = {{0, 1, Pose::translation_of(1.0, 0.0, 0.0), Matrix6::Identity(), EdgeKind::odometry},
                 {0, 1, Pose::translation_of(2.0, 0.0, 0.0), 3.0 * Matrix6::Identity(), EdgeKind::loop}};
  const auto solution = optimize(graph);
  EXPECT_NEAR(solution.poses[1].translation().x(), 1.75, 1e-12);
  EXPECT_NEAR(solution.cost_final, 0.5625 + 3.0 * 0.0625, 1e-12);
  EXPECT_NEAR(solution.cost_initial, 36.0 + 75.0, 1e-12);
}

TEST(Optimizer, KeepsTheSmallestKeyOfEachComponent) {
  Rng rng(12);
  auto made = test::make_graph<Pose>(rng, 8, 6, 0.05);
  for (std::size_t i = 0; i < 8; ++i) made.graph.nodes[i].key = (i * 3 + 5) % 8;
  made.graph.nodes.push_back({100, Pose::translation_of(1.0, 2.0, 3.0)});
  const Components components = connected_components(made.graph);
  ASSERT_EQ(components.anchors.size(), 2U);
  const auto solution = optimize(made.graph);
  EXPECT_EQ(solution.status, SolveStatus::converged);
  ASSERT_FALSE(solution.notes.empty());
  for (const std::size_t anchor : components.anchors) {
    EXPECT_EQ(solution.poses[anchor].translation(), made.graph.nodes[anchor].pose.translation());
  }
}

TEST(Optimizer, SaysWhatIsWrong) {
  Rng rng(13);
  auto made = test::make_graph<Pose>(rng, 5, 3, 0.05);
  auto zero = made.graph;
  zero.edges.resize(4);
  zero.edges[3].information.setZero();
  EXPECT_EQ(optimize(zero).status, SolveStatus::singular);
  EXPECT_NE(optimize(zero).reason.find("node 4"), std::string::npos);
  auto indefinite = made.graph;
  indefinite.edges[2].information(0, 5) = indefinite.edges[2].information(5, 0) = 1e9;
  EXPECT_EQ(optimize(indefinite).status, SolveStatus::indefinite_information);
  EXPECT_EQ(indefinite_edges(indefinite), std::vector<std::size_t>{2});
  auto asymmetric = made.graph;
  asymmetric.edges[1].information(0, 1) += 100.0;
  EXPECT_EQ(optimize(asymmetric).status, SolveStatus::indefinite_information);
  auto nan = made.graph;
  nan.edges[0].information(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(optimize(nan).status, SolveStatus::indefinite_information);
  EXPECT_EQ(optimize(PoseGraph{}).status, SolveStatus::converged);
  auto loop_to_itself = made.graph;
  loop_to_itself.edges[0].to = loop_to_itself.edges[0].from;
  EXPECT_THROW(static_cast<void>(optimize(loop_to_itself)), ContractViolation);
}

TEST(Optimizer, GivesTheSameBytesWithAnyNumberOfThreads) {
  Rng rng(14);
  const auto made = test::make_graph<Pose>(rng, 400, 500, 0.02);
  const int before = num_threads();
  std::vector<Solution<Pose>> solutions;
  for (const int threads : {1, 3}) {
    set_num_threads(threads);
    solutions.push_back(optimize(made.graph));
  }
  set_num_threads(before);
  EXPECT_EQ(solutions[0].cost_final, solutions[1].cost_final);
  for (std::size_t i = 0; i < 400; ++i) {
    EXPECT_EQ(solutions[0].poses[i].matrix(), solutions[1].poses[i].matrix());
  }
}

TEST(Chordal, IsExactWithoutNoise) {
  Rng rng(15);
  auto made = test::make_graph<Pose>(rng, 30, 20, 0.0);
  for (std::size_t i = 1; i < 30; ++i) made.graph.nodes[i].pose = test::random_pose<Pose>(rng, 20.0);
  const auto poses = chordal_poses(made.graph);
  ASSERT_TRUE(poses);
  for (std::size_t i = 0; i < 30; ++i)
    EXPECT_LT(between_residual(Pose(), (*poses)[i], made.truth[i]).norm(), 1e-9);
  auto plane = test::make_graph<Pose2>(rng, 30, 20, 0.0);
  for (std::size_t i = 1; i < 30; ++i) plane.graph.nodes[i].pose = test::random_pose<Pose2>(rng, 20.0);
  const auto poses2 = chordal_poses(plane.graph);
  ASSERT_TRUE(poses2);
  for (std::size_t i = 0; i < 30; ++i)
    EXPECT_LT(between_residual(Pose2(), (*poses2)[i], plane.truth[i]).norm(), 1e-9);
}

template <class P>
void expect_dense_marginals() {
  Rng rng(16);
  const auto made = test::make_graph<P>(rng, 12, 10, 0.05);
  constexpr int D = P::kDof;
  Eigen::VectorXd g;
  const Eigen::MatrixXd covariance = dense_hessian(made.graph, poses_of(made.graph), g).inverse();
  const auto marginals = Marginals<P>::compute(made.graph);
  ASSERT_TRUE(marginals);
  EXPECT_EQ(marginals->covariance(0).norm(), 0.0);
  const Eigen::MatrixXd expected = covariance.block(3 * D, 3 * D, D, D);
  EXPECT_LT((marginals->covariance(4) - expected).norm(), 1e-9 * expected.norm());
  EXPECT_LT(
      (marginals->joint(4, 9).template topRightCorner<D, D>() - covariance.block(3 * D, 8 * D, D, D)).norm(),
      1e-9 * expected.norm());
  const Eigen::MatrixXd cross = marginals->cross({0, 9}, {4});
  EXPECT_EQ(cross.topRows(D).norm(), 0.0);
  EXPECT_LT((cross.bottomRows(D) - covariance.block(8 * D, 3 * D, D, D)).norm(), 1e-9 * expected.norm());
  // Relative to the anchor a node's covariance is its own.
  EXPECT_LT((marginals->relative(0, 4) - expected).norm(), 1e-9 * expected.norm());
}
TEST(Marginals, EqualTheDenseInverseInSpace) { expect_dense_marginals<Pose>(); }
TEST(Marginals, EqualTheDenseInverseInThePlane) { expect_dense_marginals<Pose2>(); }

TEST(Marginals, OfOneEdgeAreItsCovariance) {
  Rng rng(17);
  const Matrix6 information = test::random_information<Pose>(rng, 3.0);
  const Pose Z = test::random_pose<Pose>(rng, 5.0);
  const Pose start = test::random_pose<Pose>(rng, 5.0);
  PoseGraph graph;
  graph.nodes = {{0, start}, {1, start * Z}, {2, start * Z * Z}};
  graph.edges = {{0, 1, Z, information, EdgeKind::odometry}, {1, 2, Z, information, EdgeKind::odometry}};
  const auto marginals = Marginals<Pose>::compute(graph);
  ASSERT_TRUE(marginals);
  const Matrix6 covariance = information.inverse();
  EXPECT_LT((marginals->relative(1, 2) - covariance).norm(), 1e-9 * covariance.norm());
}

}  // namespace
}  // namespace adit

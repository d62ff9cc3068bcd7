// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/incremental.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <set>

#include "adit/core/parallel.hpp"
#include "adit/posegraph/factors.hpp"
#include "adit/posegraph/incremental_cholesky.hpp"
#include "support/graphs.hpp"

namespace adit {
namespace {

// A matrix that grows beside its dense twin.
class Growing {
 public:
  explicit Growing(std::size_t d) : cholesky(d), d_(static_cast<Eigen::Index>(d)) {}

  void add_variable(Rng& rng) {
    const std::size_t v = cholesky.add_variable();
    const Eigen::Index n = dense.rows();
    dense.conservativeResize(n + d_, n + d_);
    dense.rightCols(d_).setZero();
    dense.bottomRows(d_).setZero();
    add_term(v, v, rng);
  }
  // J^T J of a random J over both variables: what an edge adds.
  void add_term(std::size_t i, std::size_t j, Rng& rng) {
    Eigen::MatrixXd J(d_, 2 * d_);
    for (double& v : J.reshaped()) v = rng.normal();
    const Eigen::MatrixXd H = J.transpose() * J;
    add(i, i, H.topLeftCorner(d_, d_));
    if (i == j) return;
    add(j, j, H.bottomRightCorner(d_, d_));
    add(i, j, H.topRightCorner(d_, d_));
  }
  void expect_solves() {
    ASSERT_FALSE(cholesky.refresh());
    const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(dense.rows(), -1.0, 2.0);
    const Eigen::VectorXd x = dense.llt().solve(b);
    EXPECT_LT((cholesky.solve(b) - x).norm(), 1e-8 * x.norm());
  }
  IncrementalCholesky cholesky;
  Eigen::MatrixXd dense;

 private:
  void add(std::size_t i, std::size_t j, const Eigen::MatrixXd& block) {
    cholesky.add(i, j, block);
    const auto at = [&](std::size_t v) { return static_cast<Eigen::Index>(v) * d_; };
    dense.block(at(i), at(j), d_, d_) += block;
    if (i != j) dense.block(at(j), at(i), d_, d_) += block.transpose();
  }
  Eigen::Index d_;
};

TEST(IncrementalCholesky, SolvesAsADenseFactorizationAfterEachChange) {
  for (const std::size_t d : {1U, 3U, 6U}) {
    Rng rng(d);
    Growing g(d);
    for (std::size_t i = 0; i < 40; ++i) {
      g.add_variable(rng);
      if (i > 0) g.add_term(i - 1, i, rng);
      // A chord now and then, some of them twice, in both directions.
      if (i % 7 == 6) g.add_term(rng.below(i), i, rng);
      if (i % 11 == 10) g.add_term(i, rng.below(i), rng);
      if (i % 13 == 12) g.add_term(i - 2, i - 3, rng);
      if (i % 3 == 0) g.expect_solves();
    }
    g.expect_solves();
  }
}

TEST(IncrementalCholesky, LeavesTheRestAlone) {
  Rng rng(5);
  Growing g(3);
  for (std::size_t i = 0; i < 400; ++i) {
    g.add_variable(rng);
    if (i > 0) g.add_term(i - 1, i, rng);
  }
  ASSERT_FALSE(g.cholesky.refresh());
  g.add_variable(rng);
  g.add_term(399, 400, rng);
  g.add_term(120, 400, rng);
  g.expect_solves();
  EXPECT_LT(10 * g.cholesky.num_renewed(), g.cholesky.num_supernodes());
}

TEST(IncrementalCholesky, NamesAFreeVariable) {
  IncrementalCholesky cholesky(1);
  const auto one = Eigen::MatrixXd::Ones(1, 1);
  (void)cholesky.add_variable();
  (void)cholesky.add_variable();
  cholesky.add(0, 0, one);
  EXPECT_EQ(cholesky.refresh(), 1U);
}

template <class P>
class Incremental : public testing::Test {};
using Spaces = testing::Types<Pose, Pose2>;
TYPED_TEST_SUITE(Incremental, Spaces);

// Feeds the graph edge by edge, each node when its first edge comes.
template <class P, class Check>
void feed(const BasicPoseGraph<P>& graph, IncrementalOptimizer<P>& optimizer, const Check& check) {
  std::vector<typename BasicPoseGraph<P>::Edge> loops;
  optimizer.add_node(graph.nodes[0].key, graph.nodes[0].pose);
  for (const auto& edge : graph.edges) {
    if (edge.kind == EdgeKind::loop) loops.push_back(edge);
  }
  for (const auto& edge : graph.edges) {
    if (edge.kind != EdgeKind::odometry) continue;
    optimizer.add_node(graph.nodes[edge.to].key, optimizer.poses()[edge.from] * edge.T_from_to);
    optimizer.add_edge(edge);
    for (const auto& loop : loops) {
      if (std::max(loop.from, loop.to) != edge.to) continue;
      optimizer.add_edge(loop);
      check(optimizer.update());
    }
  }
  check(optimizer.update());
}

TYPED_TEST(Incremental, ReachesTheBatchMinimumAtEachLoop) {
  using P = TypeParam;
  Rng rng(7);
  const auto made = test::make_graph<P>(rng, 120, 25, 0.02);
  OptimizerConfig config;
  config.relative_tolerance = 1e-10;
  IncrementalOptimizer<P> optimizer(config);
  feed(made.graph, optimizer, [&](const auto& update) {
    ASSERT_EQ(update.status, SolveStatus::converged) << update.reason;
    const Solution<P> batch = optimize(optimizer.graph(), config);
    EXPECT_NEAR(update.cost, batch.cost_final, 1e-5 * (1.0 + batch.cost_final));
  });
  const Solution<P> batch = optimize(made.graph, config);
  for (std::size_t i = 0; i < batch.poses.size(); ++i)
    EXPECT_LT((batch.poses[i].translation() - optimizer.poses()[i].translation()).norm(), 1e-3);
}

TYPED_TEST(Incremental, ReportsWhatItCannotSolveAndGoesOn) {
  using P = TypeParam;
  IncrementalOptimizer<P> optimizer;
  optimizer.add_node(0, P());
  optimizer.add_node(1, P());
  EXPECT_EQ(optimizer.update().status, SolveStatus::singular);
  optimizer.add_edge({0, 1, P(), P::Jacobian::Identity(), EdgeKind::odometry});
  const auto update = optimizer.update();
  EXPECT_EQ(update.status, SolveStatus::converged) << update.reason;
  typename P::Jacobian bad = P::Jacobian::Identity();
  bad(0, 0) = -1.0;
  optimizer.add_edge({0, 1, P(), bad, EdgeKind::loop});
  EXPECT_EQ(optimizer.update().status, SolveStatus::indefinite_information);
}

TYPED_TEST(Incremental, GivesTheSameBytesWithAnyNumberOfThreads) {
  using P = TypeParam;
  std::set<std::vector<double>> results;
  for (const int threads : {1, 2}) {
    set_num_threads(threads);
    Rng rng(8);
    const auto made = test::make_graph<P>(rng, 600, 12, 0.02);
    IncrementalOptimizer<P> optimizer;
    feed(made.graph, optimizer, [](const auto&) {});
    std::vector<double> numbers;
    for (const P& pose : optimizer.poses()) {
      for (const double x : pose.translation()) numbers.push_back(x);
    }
    results.insert(numbers);
  }
  EXPECT_EQ(results.size(), 1U);
}

TEST(IncrementalCholesky, RemovedTermsLeaveNoTrace) {
  Rng rng(11);
  Growing g(3);
  for (std::size_t i = 0; i < 60; ++i) {
    g.add_variable(rng);
    if (i > 0) g.add_term(i - 1, i, rng);
  }
  g.expect_solves();
  const Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(g.dense.rows(), -1.0, 2.0);
  const Eigen::VectorXd before = g.cholesky.solve(b);
  const Eigen::Matrix3d term = 0.1 * Eigen::Matrix3d::Identity();
  g.cholesky.add(5, 50, term);
  g.cholesky.add(50, 5, term);
  ASSERT_FALSE(g.cholesky.refresh());
  EXPECT_GT((g.cholesky.solve(b) - before).norm(), 1e-3 * before.norm());
  g.cholesky.remove(5, 50, term);
  g.cholesky.remove(5, 50, term.transpose());
  ASSERT_FALSE(g.cholesky.refresh());
  EXPECT_LT((g.cholesky.solve(b) - before).norm(), 1e-9 * before.norm());
  g.expect_solves();
}

// What an edge does that is linearized anew: its pair is without a term for a moment only.
TEST(IncrementalCholesky, ReplacedTermsCountAsTheLastOnes) {
  Rng rng(13);
  Growing g(3);
  for (std::size_t i = 0; i < 60; ++i) {
    g.add_variable(rng);
    if (i > 0) g.add_term(i - 1, i, rng);
  }
  const Eigen::Matrix3d term = 0.1 * Eigen::Matrix3d::Identity();
  g.cholesky.add(5, 50, term);
  ASSERT_FALSE(g.cholesky.refresh());
  const std::size_t num_supernodes = g.cholesky.num_supernodes();
  g.cholesky.remove(5, 50, term);
  g.cholesky.add(5, 50, 2.0 * term);
  ASSERT_FALSE(g.cholesky.refresh());
  EXPECT_EQ(g.cholesky.num_supernodes(), num_supernodes);
  // Removed twice, in use in between, and another pair that takes a place that became free.
  g.cholesky.remove(50, 5, 2.0 * term);
  g.cholesky.add(50, 5, term);
  g.cholesky.remove(5, 50, term);
  g.cholesky.add(7, 30, term);
  ASSERT_FALSE(g.cholesky.refresh());
  g.cholesky.add(9, 40, -term);
  g.cholesky.remove(7, 30, term);
  g.cholesky.remove(9, 40, -term);
  g.expect_solves();
}

TEST(IncrementalCholesky, QuadraticFormsAndSparseSolutionsAreThoseOfTheDenseInverse) {
  Rng rng(12);
  Growing g(3);
  for (std::size_t i = 0; i < 50; ++i) {
    g.add_variable(rng);
    if (i > 0) g.add_term(i - 1, i, rng);
    if (i % 9 == 8) g.add_term(rng.below(i), i, rng);
  }
  ASSERT_FALSE(g.cholesky.refresh());
  Eigen::MatrixXd columns(6, 4);
  for (double& x : columns.reshaped()) x = rng.normal();
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(g.dense.rows(), 4);
  all.middleRows(3 * 7, 3) = columns.topRows(3);
  all.middleRows(3 * 41, 3) = columns.bottomRows(3);
  const Eigen::MatrixXd expected = all.transpose() * g.dense.llt().solve(all);
  EXPECT_LT((g.cholesky.quadratic_form({7, 41}, columns) - expected).norm(), 1e-9 * expected.norm());

  const IncrementalCholesky::Sparse b{{7}, {1.0, -2.0, 0.5}};
  Eigen::VectorXd dense_b = Eigen::VectorXd::Zero(g.dense.rows());
  dense_b.segment(21, 3) << 1.0, -2.0, 0.5;
  const Eigen::VectorXd x = g.dense.llt().solve(dense_b);
  const double gain = dense_b.dot(x);
  const auto not_worth_it = g.cholesky.solve(b, 0.0, 1.01 * gain);
  EXPECT_TRUE(not_worth_it.x.variables.empty());
  EXPECT_NEAR(not_worth_it.gain, gain, 1e-9 * gain);
  for (const double threshold : {0.0, 1e-3}) {
    const auto [sparse, found_gain] = g.cholesky.solve(b, threshold, 0.99 * gain);
    EXPECT_NEAR(found_gain, gain, 1e-9 * gain);
    Eigen::VectorXd found = Eigen::VectorXd::Zero(x.size());
    for (std::size_t k = 0; k < sparse.variables.size(); ++k)
      for (std::size_t i = 0; i < 3; ++i)
        found(static_cast<Eigen::Index>(3 * sparse.variables[k] + i)) = sparse.rows[3 * k + i];
    EXPECT_LT((found - x).cwiseAbs().maxCoeff(), 1e-9 + 10.0 * threshold);
  }
}

TYPED_TEST(Incremental, EdgesTakenOutOfUseCountNoMore) {
  using P = TypeParam;
  Rng rng(9);
  const auto made = test::make_graph<P>(rng, 100, 15, 0.02);
  IncrementalOptimizer<P> optimizer;
  feed(made.graph, optimizer, [](const auto&) {});
  auto wrong = made.graph.edges.front();
  wrong.from = 3;
  wrong.to = 90;
  wrong.kind = EdgeKind::loop;
  const double cost = optimizer.update().cost;
  const std::size_t e = optimizer.add_edge(wrong);
  EXPECT_GT(optimizer.update().cost, 2.0 * cost);
  optimizer.set_use(e, EdgeUse::out_of_use);
  EXPECT_NEAR(optimizer.update().cost, cost, 1e-4 * cost);
  EXPECT_FALSE(optimizer.is_used(e));
}

TYPED_TEST(Incremental, AnUpdateThatMayNotSolveIsFinishedByLaterOnes) {
  using P = TypeParam;
  Rng rng(15);
  const auto made = test::make_graph<P>(rng, 80, 12, 0.02);
  IncrementalOptimizer<P> at_once;
  IncrementalOptimizer<P> in_parts;
  feed(made.graph, at_once, [](const auto&) {});
  feed(made.graph, in_parts, [](const auto&) {});
  auto pulls = made.graph.edges.front();
  pulls.from = 5;
  pulls.to = 60;
  at_once.add_edge(pulls);
  in_parts.add_edge(pulls);
  const auto waits = in_parts.update(0);
  EXPECT_EQ(waits.status, SolveStatus::max_iterations);
  EXPECT_TRUE(waits.moved.empty());
  const double cost = at_once.update().cost;
  EXPECT_GT(waits.cost, 1.1 * cost);
  auto part = in_parts.update(1);
  for (int k = 0; k < 50 && part.status == SolveStatus::max_iterations; ++k) part = in_parts.update(1);
  EXPECT_EQ(part.status, SolveStatus::converged);
  EXPECT_NEAR(part.cost, cost, 1e-3 * cost);
}

TYPED_TEST(Incremental, SolvesNothingWhereNothingHasChanged) {
  using P = TypeParam;
  Rng rng(14);
  const auto made = test::make_graph<P>(rng, 80, 12, 0.02);
  IncrementalOptimizer<P> optimizer;
  feed(made.graph, optimizer, [](const auto&) {});
  const auto again = optimizer.update();
  EXPECT_EQ(again.status, SolveStatus::converged);
  EXPECT_EQ(again.iterations, 0);
  EXPECT_TRUE(again.moved.empty());
  double sum = 0.0;
  for (std::size_t e = 0; e < optimizer.graph().edges.size(); ++e) {
    const auto& edge = optimizer.graph().edges[e];
    const auto r = between_residual(edge.T_from_to, optimizer.poses()[edge.from], optimizer.poses()[edge.to]);
    EXPECT_NEAR(optimizer.chi2(e), r.dot(edge.information * r), 1e-9 * (1.0 + optimizer.chi2(e)));
    sum += optimizer.chi2(e);
  }
  EXPECT_NEAR(again.cost, sum, 1e-9 * sum);
  // An edge that pulls, and the same taken out again, both count.
  auto pulls = made.graph.edges.front();
  pulls.from = 5;
  pulls.to = 60;
  const std::size_t e = optimizer.add_edge(pulls);
  EXPECT_GT(optimizer.update().iterations, 0);
  optimizer.set_use(e, EdgeUse::out_of_use);
  EXPECT_GT(optimizer.update().iterations, 0);
}

// What a new measurement adds to the cost is, to first order, its chi2 by the predicted covariance and its
// own.
TYPED_TEST(Incremental, PredictsWhatALoopWillCost) {
  using P = TypeParam;
  Rng rng(10);
  const auto made = test::make_graph<P>(rng, 60, 10, 1e-3);
  OptimizerConfig config;
  config.relative_tolerance = 1e-10;
  IncrementalOptimizer<P> optimizer(config);
  feed(made.graph, optimizer, [](const auto&) {});
  const double before = optimizer.update().cost;
  typename BasicPoseGraph<P>::Edge loop{10, 40, made.truth[10].inverse() * made.truth[40],
                                        1e6 * P::Jacobian::Identity(), EdgeKind::loop};
  loop.T_from_to = retract(loop.T_from_to, test::random_tangent<P>(rng, 1e-3));
  const std::size_t e = optimizer.add_edge(loop, EdgeUse::out_of_use);
  (void)optimizer.update();
  const auto prediction = optimizer.predict({e});
  const Eigen::MatrixXd covariance = prediction.covariance + Eigen::MatrixXd(loop.information.inverse());
  const double chi2 = prediction.residual.dot(covariance.llt().solve(prediction.residual));
  optimizer.set_use(e, EdgeUse::in_use);
  EXPECT_NEAR(optimizer.update().cost - before, chi2, 0.05 * chi2 + 1e-3);
}

}  // namespace
}  // namespace adit

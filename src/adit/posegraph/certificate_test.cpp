// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/certificate.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <numbers>
#include <numeric>

#include "adit/core/parallel.hpp"
#include "adit/posegraph/certificate_matrix.hpp"
#include "adit/posegraph/gnc.hpp"
#include "support/graphs.hpp"

namespace adit {
namespace {

template <class P>
double form_at(const EdgeMinorant<P>& m, const P& T_from_to) {
  const auto v = T_from_to.translation();
  return m.stiffness * v.squaredNorm() - 2.0 * m.lever.dot(v) -
         (m.turn.transpose() * T_from_to.rotation_matrix()).trace();
}

// Everything rests on this: nowhere above chi2, and as far below it as `slack` says where it touches.
template <class P>
void expect_below(bool with_cross_blocks, double spread) {
  constexpr int d = kSpaceOf<P>;
  Rng rng(1);
  for (int i = 0; i < 300; ++i) {
    typename BasicPoseGraph<P>::Edge edge{0, 1, test::random_pose<P>(rng, 2.0),
                                          test::random_information<P>(rng, 3.0), EdgeKind::loop};
    if (!with_cross_blocks) {
      edge.information.template topRightCorner<d, P::kDof - d>().setZero();
      edge.information.template bottomLeftCorner<P::kDof - d, d>().setZero();
    }
    const auto chi2 = [&](const P& T) {
      const auto r = between_residual(edge.T_from_to, P(), T);
      return r.dot(edge.information * r);
    };
    const P at = retract(edge.T_from_to, test::random_tangent<P>(rng, spread));
    const EdgeMinorant<P> m = minorant_at<P>(edge, between_residual(edge.T_from_to, P(), at));
    EXPECT_GE(m.slack, 0.0);
    const double constant = chi2(at) - m.slack - form_at(m, at);
    for (int k = 0; k < 200; ++k) {
      const double size = k % 2 == 0 ? 0.1 : 2.0;
      const P other = retract(k % 3 == 0 ? edge.T_from_to : at, test::random_tangent<P>(rng, size));
      EXPECT_LE(form_at(m, other) + constant, chi2(other) + 1e-9 * (1.0 + chi2(other)));
    }
  }
}
TEST(Minorant, LiesBelowChi2Everywhere) {
  for (const bool with_cross_blocks : {false, true}) {
    for (const double spread : {0.01, 0.3, 3.0}) {
      expect_below<Pose>(with_cross_blocks, spread);
      expect_below<Pose2>(with_cross_blocks, spread);
    }
  }
}

TEST(Minorant, TouchesChi2InThePlaneAndForIsotropicRotations) {
  Rng rng(2);
  for (int i = 0; i < 50; ++i) {
    const PoseGraph2::Edge flat{0, 1, test::random_pose<Pose2>(rng, 2.0),
                                test::random_information<Pose2>(rng, 3.0), EdgeKind::loop};
    EXPECT_LT(minorant_at<Pose2>(flat, test::random_tangent<Pose2>(rng, 0.005)).slack, 1e-9);
    PoseGraph::Edge edge{0, 1, test::random_pose<Pose>(rng, 2.0), Matrix6::Identity(), EdgeKind::loop};
    edge.information.topLeftCorner<3, 3>() = test::random_information<Pose>(rng, 3.0).topLeftCorner<3, 3>();
    EXPECT_LT(minorant_at<Pose>(edge, test::random_tangent<Pose>(rng, 0.5)).slack, 1e-9);
  }
}

// Translations and rotations known about as well in all directions, without cross blocks: what the minorants
// can follow. In the plane any information will do.
Matrix6 mild_information(Rng& rng, double sigma) {
  Matrix6 information = Matrix6::Zero();
  for (const int at : {0, 3}) {
    const Matrix3 R = so3::exp(test::random_tangent<Pose>(rng, 1.0).head<3>()).toRotationMatrix();
    information.block<3, 3>(at, at) = R * Vector3(4.0, 3.0, 1.5).asDiagonal() * R.transpose();
  }
  return information / (sigma * sigma);
}
template <class P>
test::Made<P> make_mild_graph(Rng& rng, std::size_t num_nodes, std::size_t num_loops, double sigma) {
  auto made = test::make_graph<P>(rng, num_nodes, num_loops, sigma);
  if constexpr (P::kDof == 6) {
    for (auto& edge : made.graph.edges) edge.information = mild_information(rng, sigma);
  }
  return made;
}

template <class P>
Eigen::MatrixXd dense_matrix(const BasicPoseGraph<P>& graph, const std::vector<P>& poses) {
  constexpr int D = kBlockOf<P>;
  const GraphStructure structure = structure_of(graph, connected_components(graph), {});
  std::vector<EdgeMinorant<P>> minorants;
  for (const auto& edge : graph.edges)
    minorants.push_back(
        minorant_at<P>(edge, between_residual(edge.T_from_to, poses[edge.from], poses[edge.to])));
  const CertificateMatrix matrix = certificate_matrix(graph, structure, poses, minorants);
  const auto n = static_cast<Eigen::Index>(structure.pattern.size()) * D;
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t j = 0; j < structure.pattern.size(); ++j) {
    for (std::size_t b = structure.pattern.column_start[j]; b < structure.pattern.column_start[j + 1]; ++b) {
      const Eigen::Map<const Eigen::Matrix<double, D, D>> block(matrix.values.data() + b * D * D);
      const auto row = static_cast<Eigen::Index>(structure.pattern.row[b]) * D;
      const auto column = static_cast<Eigen::Index>(j) * D;
      S.block<D, D>(row, column) = block;
      S.block<D, D>(column, row) = block.transpose();
    }
  }
  return S;
}

// Translations eliminated by a dense Schur complement, all eigenvalues by a dense method.
template <class P>
double dense_smallest_eigenvalue(const Eigen::MatrixXd& S) {
  constexpr int D = kBlockOf<P>;
  std::vector<Eigen::Index> rotations;
  std::vector<Eigen::Index> translations;
  for (Eigen::Index i = 0; i < S.rows(); ++i) (i % D == D - 1 ? translations : rotations).push_back(i);
  const Eigen::MatrixXd coupling = S(rotations, translations);
  const Eigen::MatrixXd schur =
      S(rotations, rotations) - coupling * S(translations, translations).inverse() * coupling.transpose();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(schur).eigenvalues()(0);
}

template <class P>
void expect_dense_eigenvalue() {
  Rng rng(3);
  int num_positive = 0;
  int num_negative = 0;
  for (int i = 0; i < 10; ++i) {
    const auto made = make_mild_graph<P>(rng, 12, 10, 0.02);
    const auto solution = optimize(made.graph);
    const Certificate c = certify(made.graph, solution.poses);
    const double expected = dense_smallest_eigenvalue<P>(dense_matrix(made.graph, solution.poses));
    EXPECT_GE(c.smallest_eigenvalue, expected - 1e-6 * std::abs(expected));
    EXPECT_LE(c.smallest_eigenvalue, 1.2 * expected);
    num_positive += expected > 0.0 ? 1 : 0;
    EXPECT_EQ(c.optimality == Optimality::globally_optimal, expected > 0.0 && c.gap <= 1e-3) << c.reason;
    // Away from the minimum the matrix is indefinite at last.
    std::vector<P> moved = solution.poses;
    for (P& pose : moved) pose = retract(pose, test::random_tangent<P>(rng, 0.5));
    const double there = dense_smallest_eigenvalue<P>(dense_matrix(made.graph, moved));
    EXPECT_EQ(certify(made.graph, moved).smallest_eigenvalue > 0.0, there > 0.0);
    num_negative += there < 0.0 ? 1 : 0;
  }
  EXPECT_GE(num_positive, 8);
  EXPECT_GE(num_negative, 8);
}
TEST(Certificate, EigenvalueEqualsTheDenseOneInSpace) { expect_dense_eigenvalue<Pose>(); }
TEST(Certificate, EigenvalueEqualsTheDenseOneInThePlane) { expect_dense_eigenvalue<Pose2>(); }

// From many random starts: the best minimum found respects every bound, worse minima are not certified, and
// the best one usually is.
template <class P>
void expect_never_wrong(double sigma) {
  int num_certified = 0;
  int num_worse = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    Rng rng(seed);
    auto graph = make_mild_graph<P>(rng, 10, 12, sigma).graph;
    std::vector<Solution<P>> minima{optimize(graph)};
    for (int start = 0; start < 12; ++start) {
      auto turned = graph;
      for (std::size_t i = 1; i < turned.nodes.size(); ++i)
        turned.nodes[i].pose = test::random_pose<P>(rng, 2.0);
      OptimizerConfig config;
      config.initialization = SolveStart::given;
      minima.push_back(optimize(turned, config));
    }
    const auto less = [](const auto& a, const auto& b) { return a.cost_final < b.cost_final; };
    const double best = std::ranges::min_element(minima, less)->cost_final;
    for (const Solution<P>& s : minima) {
      const Certificate c = certify(graph, s.poses);
      EXPECT_LE(c.lower_bound, best * (1.0 + 1e-9)) << seed;
      const bool is_worse = s.cost_final > (1.0 + 2e-3) * best;
      EXPECT_FALSE(is_worse && c.optimality == Optimality::globally_optimal) << seed;
      num_worse += is_worse ? 1 : 0;
    }
    const Certificate c = certify(graph, std::ranges::min_element(minima, less)->poses);
    num_certified += c.optimality == Optimality::globally_optimal ? 1 : 0;
  }
  EXPECT_GE(num_certified, sigma < 0.1 ? 25 : 1);
  EXPECT_GT(num_worse, 50);
}
TEST(Certificate, IsNeverWrongInSpace) {
  for (const double sigma : {0.01, 0.3}) expect_never_wrong<Pose>(sigma);
}
TEST(Certificate, IsNeverWrongInThePlane) {
  for (const double sigma : {0.01, 0.3}) expect_never_wrong<Pose2>(sigma);
}

// A ring whose start turns once too often: each joint is a little bent, and no small change unwinds it.
template <class P>
P turn_and_go(double turn);
template <>
Pose2 turn_and_go(double turn) {
  return {std::cos(0.5 * turn), std::sin(0.5 * turn), turn};
}
template <>
Pose turn_and_go(double turn) {
  return Pose::planar(std::cos(0.5 * turn), std::sin(0.5 * turn), turn);
}
template <class P>
BasicPoseGraph<P> wound_ring(std::size_t num_nodes, Rng& rng) {
  const double turn = 2.0 * std::numbers::pi / static_cast<double>(num_nodes);
  BasicPoseGraph<P> graph;
  P pose;
  for (std::size_t i = 0; i < num_nodes; ++i) {
    graph.nodes.push_back({i, pose});
    pose = pose * turn_and_go<P>(2.0 * turn);
    auto information = BasicPoseGraph<P>::Information::Identity().eval();
    information.template topLeftCorner<kSpaceOf<P>, kSpaceOf<P>>() *= 0.01;
    graph.edges.push_back({i, (i + 1) % num_nodes,
                           retract(turn_and_go<P>(turn), test::random_tangent<P>(rng, 0.01)), information,
                           i + 1 < num_nodes ? EdgeKind::odometry : EdgeKind::loop});
  }
  return graph;
}
OptimizerConfig from_given() {
  OptimizerConfig config;
  config.initialization = SolveStart::given;
  return config;
}
template <class P>
void expect_unwound() {
  Rng rng(4);
  const auto graph = wound_ring<P>(20, rng);
  const auto stuck = optimize(graph, from_given());
  EXPECT_GT(stuck.cost_final, 1.0);
  EXPECT_NE(certify(graph, stuck.poses).optimality, Optimality::globally_optimal);
  const Certified<P> free = improved(graph, certified(graph, stuck));
  EXPECT_EQ(free.given, Optimality::not_optimal);
  EXPECT_EQ(free.certificate.optimality, Optimality::globally_optimal) << free.certificate.reason;
  EXPECT_GE(free.descents, 1);
  EXPECT_LT(free.solution.cost_final, 0.1);
}
TEST(Certificate, WoundRingIsNotCertifiedAndUnwoundInThePlane) { expect_unwound<Pose2>(); }
TEST(Certificate, WoundRingIsNotCertifiedAndUnwoundInSpace) {
  // In space a double turn can be unwound: started there, the search itself does it or is told to.
  Rng rng(4);
  const auto graph = wound_ring<Pose>(20, rng);
  const Certified<Pose> free = improved(graph, certified(graph, optimize(graph, from_given())));
  EXPECT_EQ(free.certificate.optimality, Optimality::globally_optimal) << free.certificate.reason;
  EXPECT_LT(free.solution.cost_final, 0.1);
}

TEST(Certificate, GaugeAndOrderOfNodesDoNotMatter) {
  Rng rng(5);
  const auto made = make_mild_graph<Pose>(rng, 30, 30, 0.03);
  const auto solution = optimize(made.graph);
  const Certificate expected = certify(made.graph, solution.poses);
  EXPECT_EQ(expected.optimality, Optimality::globally_optimal) << expected.reason;
  std::vector<std::size_t> order(30);
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = 29; i > 0; --i) std::swap(order[i], order[rng.below(i + 1)]);
  const Pose moved = test::random_pose<Pose>(rng, 100.0);
  PoseGraph graph = made.graph;
  std::vector<Pose> poses(30);
  for (std::size_t i = 0; i < 30; ++i) {
    graph.nodes[order[i]] = {order[i], Pose()};
    poses[order[i]] = moved * solution.poses[i];
  }
  for (auto& edge : graph.edges) {
    edge.from = order[edge.from];
    edge.to = order[edge.to];
  }
  const Certificate c = certify(graph, poses);
  EXPECT_EQ(c.optimality, expected.optimality);
  EXPECT_NEAR(c.cost, expected.cost, 1e-9 * expected.cost);
  EXPECT_NEAR(c.gap, expected.gap, 1e-6);
}

// One wound ring spoils the verdict, and only it is repaired.
TEST(Certificate, JudgesAllComponents) {
  Rng rng(6);
  PoseGraph2 graph = wound_ring<Pose2>(20, rng);
  auto other = make_mild_graph<Pose2>(rng, 15, 15, 0.02).graph;
  for (auto& node : other.nodes) graph.nodes.push_back({node.key + 100, node.pose});
  for (auto edge : other.edges) {
    edge.from += 20;
    edge.to += 20;
    graph.edges.push_back(edge);
  }
  const auto stuck = optimize(graph, from_given());
  EXPECT_NE(certify(graph, stuck.poses).optimality, Optimality::globally_optimal);
  const Certified<Pose2> free = improved(graph, certified(graph, stuck));
  EXPECT_EQ(free.certificate.optimality, Optimality::globally_optimal) << free.certificate.reason;
  EXPECT_NEAR(free.solution.cost_final, optimize(other).cost_final, 0.1);
}

TEST(Certificate, SpeaksOfTheEdgesThatAreKept) {
  Rng rng(7);
  auto graph = make_mild_graph<Pose>(rng, 40, 60, 0.01).graph;
  graph.edges.push_back(
      {3, 30, test::random_pose<Pose>(rng, 20.0), 1e4 * Matrix6::Identity(), EdgeKind::loop});
  const auto solution = optimize_gnc(graph);
  ASSERT_EQ(solution.edge_weights.back(), 0.0);
  const Certificate kept = certify(graph, solution.poses, {}, solution.edge_weights);
  EXPECT_EQ(kept.optimality, Optimality::globally_optimal) << kept.reason;
  EXPECT_NEAR(kept.cost, solution.cost_final, 1e-9 * solution.cost_final);
  EXPECT_NE(certify(graph, solution.poses).optimality, Optimality::globally_optimal);
}

TEST(Certificate, PosesThatAreNoMinimumAreNotCertified) {
  Rng rng(8);
  const auto made = make_mild_graph<Pose2>(rng, 20, 20, 0.02);
  EXPECT_NE(certify(made.graph, poses_of(made.graph)).optimality, Optimality::globally_optimal);
  const Certificate c = certify(made.graph, optimize(made.graph).poses);
  EXPECT_EQ(c.optimality, Optimality::globally_optimal) << c.reason;
  EXPECT_LE(c.lower_bound, c.cost);
}

TEST(Certificate, GivesTheSameBytesWithAnyNumberOfThreads) {
  Rng rng(9);
  const auto ring = wound_ring<Pose2>(600, rng);
  const auto made = make_mild_graph<Pose>(rng, 400, 500, 0.02);
  const auto stuck = optimize(ring, from_given());
  const auto solution = optimize(made.graph);
  const int before = num_threads();
  std::vector<Certificate> space;
  std::vector<Certified<Pose2>> plane;
  for (const int threads : {1, 2}) {
    set_num_threads(threads);
    space.push_back(certify(made.graph, solution.poses));
    plane.push_back(improved(ring, certified(ring, stuck)));
  }
  set_num_threads(before);
  EXPECT_EQ(space[0].lower_bound, space[1].lower_bound);
  EXPECT_EQ(space[0].smallest_eigenvalue, space[1].smallest_eigenvalue);
  EXPECT_EQ(plane[0].solution.cost_final, plane[1].solution.cost_final);
  EXPECT_EQ(plane[0].certificate.lower_bound, plane[1].certificate.lower_bound);
}

TEST(Certificate, GraphsWithNothingToMoveAreOptimal) {
  EXPECT_EQ(certify(PoseGraph{}, {}).optimality, Optimality::globally_optimal);
  PoseGraph one;
  one.nodes = {{4, Pose()}};
  EXPECT_EQ(certify(one, {Pose()}).optimality, Optimality::globally_optimal);
}

}  // namespace
}  // namespace adit

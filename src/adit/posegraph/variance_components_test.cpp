// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/posegraph/variance_components.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "adit/core/rng.hpp"
#include "adit/posegraph/factors.hpp"

namespace adit {
namespace {

enum Source : std::size_t { kOdometry, kLoops, kNumSources };

template <class P>
struct Drive {
  BasicPoseGraph<P> graph;
  std::vector<std::size_t> source_of_edge;
};

template <class P>
typename P::Tangent noise(Rng& rng, double sigma) {
  typename P::Tangent out;
  for (double& x : out) x = sigma * rng.normal();
  return out;
}

template <class P>
P on_circle(double angle) {
  if constexpr (P::kDof == 6)
    return Pose::planar(10.0 * std::sin(angle), -10.0 * std::cos(angle), angle, 0.2 * angle);
  else
    return Pose2(10.0 * std::sin(angle), -10.0 * std::cos(angle), angle);
}

/// Laps of 40 nodes with a loop to the lap before at every `stride`-th; all state 2 cm and 20 mrad, and err
/// by the root of the variance of their source times that.
template <class P>
Drive<P> laps(std::size_t num_nodes, std::size_t stride, double odometry, double loops, std::uint64_t seed) {
  constexpr std::size_t kNodesOfLap = 40;
  Rng rng(seed);
  Drive<P> out;
  std::vector<P> truth;
  const auto link = [&](std::size_t from, std::size_t to, EdgeKind kind, double variance) {
    const P error = P::exp(noise<P>(rng, test::kSigma * std::sqrt(variance)));
    out.graph.edges.push_back({from, to, truth[from].inverse() * truth[to] * error,
                               P::Jacobian::Identity() / (test::kSigma * test::kSigma), kind});
    out.source_of_edge.push_back(kind == EdgeKind::loop ? kLoops : kOdometry);
  };
  for (std::size_t i = 0; i < num_nodes; ++i) {
    truth.push_back(on_circle<P>(2.0 * std::numbers::pi * static_cast<double>(i) / kNodesOfLap));
    out.graph.nodes.push_back({i, truth.back()});
    if (i > 0) link(i - 1, i, EdgeKind::odometry, odometry);
    if (i >= kNodesOfLap && i % stride == 0) link(i - kNodesOfLap, i, EdgeKind::loop, loops);
  }
  return out;
}

template <class P>
BalancedSolution<P> balanced(const Drive<P>& drive) {
  return optimize_balanced(drive.graph, drive.source_of_edge, kNumSources, {}, {});
}

TEST(VarianceComponents, TellSourcesThatStateTooMuchFromThoseThatStateTooLittle) {
  constexpr double kFactor = 1.6;  // few numbers of the more precise source are redundant
  for (const auto& [odometry, loops] : {std::pair(1.0, 1.0), {0.25, 4.0}, {4.0, 0.25}, {1.0, 25.0}}) {
    const auto in_space = balanced(laps<Pose>(400, 1, odometry, loops, 1)).components;
    const auto in_plane = balanced(laps<Pose2>(400, 1, odometry, loops, 2)).components;
    for (const auto& components : {in_space, in_plane}) {
      EXPECT_LT(std::abs(std::log(components[kOdometry].variance / odometry)), std::log(kFactor))
          << odometry << " " << loops;
      EXPECT_LT(std::abs(std::log(components[kLoops].variance / loops)), std::log(kFactor))
          << odometry << " " << loops;
    }
  }
}

TEST(VarianceComponents, NoSourceCountsAsBetterThanTheLeast) {
  const Drive<Pose> drive = laps<Pose>(240, 1, 0.1, 4.0, 1);
  const auto free = balanced(drive).components;
  const auto bounded =
      optimize_balanced(drive.graph, drive.source_of_edge, kNumSources, {}, {}, 1.0).components;
  EXPECT_LT(free[kOdometry].variance, 0.5);
  EXPECT_EQ(bounded[kOdometry].variance, 1.0);
  EXPECT_GT(bounded[kLoops].variance, 2.0) << "those that err more than they state are found out still";
}

TEST(VarianceComponents, BringTheSolutionNearerToTheTruth) {
  double squared = 0.0;
  double squared_unbalanced = 0.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Drive<Pose> drive = laps<Pose>(240, 2, 0.2, 10.0, seed);
    const std::vector<Pose> with = balanced(drive).solution.poses;
    const std::vector<Pose> without = optimize(drive.graph).poses;
    for (std::size_t i = 0; i < with.size(); ++i) {
      squared += (with[i].translation() - drive.graph.nodes[i].pose.translation()).squaredNorm();
      squared_unbalanced +=
          (without[i].translation() - drive.graph.nodes[i].pose.translation()).squaredNorm();
    }
  }
  EXPECT_LT(squared, 0.7 * squared_unbalanced);
}

// The oracle: n - tr(Omega J H^-1 J^T) by dense matrices.
TEST(VarianceComponents, RedundancyIsThatOfTheDenseProjection) {
  const Drive<Pose> drive = laps<Pose>(120, 4, 1.0, 1.0, 3);
  const BalancedSolution<Pose> found = balanced(drive);
  const auto size = static_cast<Eigen::Index>(6 * (drive.graph.nodes.size() - 1));
  const auto rows = static_cast<Eigen::Index>(6 * drive.graph.edges.size());
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(rows, size);
  for (std::size_t e = 0; e < drive.graph.edges.size(); ++e) {
    const auto& edge = drive.graph.edges[e];
    const auto f = linearize(edge.T_from_to, found.solution.poses[edge.from], found.solution.poses[edge.to]);
    const double root =
        std::sqrt(edge.information(0, 0) / found.components[drive.source_of_edge[e]].variance);
    const auto row = static_cast<Eigen::Index>(6 * e);
    if (edge.from > 0) J.block<6, 6>(row, static_cast<Eigen::Index>(6 * (edge.from - 1))) = root * f.d_from;
    J.block<6, 6>(row, static_cast<Eigen::Index>(6 * (edge.to - 1))) = root * f.d_to;
  }
  const Eigen::MatrixXd projection = J * (J.transpose() * J).inverse() * J.transpose();
  double expected = 0.0;
  for (std::size_t e = 0; e < drive.graph.edges.size(); ++e)
    if (drive.source_of_edge[e] == kLoops)
      expected +=
          6.0 -
          projection.block<6, 6>(static_cast<Eigen::Index>(6 * e), static_cast<Eigen::Index>(6 * e)).trace();
  EXPECT_NEAR(found.components[kLoops].redundancy, expected, 0.15 * expected);
  const double all = found.components[kLoops].redundancy + found.components[kOdometry].redundancy;
  EXPECT_NEAR(all, static_cast<double>(rows - size), 0.05 * static_cast<double>(rows - size));
}

TEST(VarianceComponents, AnExactFitOfFewMeasurementsSaysLittle) {
  const Drive<Pose> drive = laps<Pose>(60, 40, 0.0, 0.0, 1);  // one loop
  const auto components = balanced(drive).components;
  EXPECT_EQ(components[kLoops].num_edges, 1U);
  EXPECT_GT(components[kLoops].variance, 0.4);
  EXPECT_LE(components[kLoops].variance, 1.0);
}

TEST(VarianceComponents, LoopsOfNoWeightHaveNoSay) {
  Drive<Pose> drive = laps<Pose>(200, 1, 1.0, 1.0, 5);
  std::vector<double> weights(drive.graph.edges.size(), 1.0);
  for (std::size_t e = 0; e < weights.size(); e += 7) {
    if (drive.source_of_edge[e] != kLoops) continue;
    weights[e] = 0.0;
    drive.graph.edges[e].T_from_to = Pose::planar(3.0, 1.0, 1.0);
  }
  const auto components =
      optimize_balanced(drive.graph, drive.source_of_edge, kNumSources, {}, weights).components;
  EXPECT_NEAR(components[kLoops].variance, 1.0, 0.2);
}

TEST(VarianceComponents, AGraphThatCannotBeSolvedSaysSo) {
  Drive<Pose> drive = laps<Pose>(60, 1, 1.0, 1.0, 1);
  drive.graph.edges.front().information(0, 0) = -1.0;
  const auto found = balanced(drive);
  EXPECT_EQ(found.solution.status, SolveStatus::indefinite_information);
  EXPECT_FALSE(found.solution.reason.empty());
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/scan_to_map.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "adit/core/parallel.hpp"
#include "support/synthetic_scan.hpp"

namespace adit {
namespace {

// Sparse source points, each with one map point some decimetres away: no nearest neighbour changes under the
// small perturbations of finite differences.
struct Pairs {
  LocalMap map{1.0, 1};
  std::vector<Eigen::Vector3f> source;
  std::vector<Eigen::Vector3f> target;
  Pose T_map_base = Pose(so3::exp({0.1, -0.2, 0.7}), Vector3(5.0, -3.0, 1.0));

  Pairs() {
    Rng rng(9);
    for (int i = 0; i < 200; ++i) {
      const Vector3 p(rng.uniform(-20, 20), rng.uniform(-20, 20), 3.0 * i - 300.0);
      source.push_back(p.cast<float>());
      const Vector3 off(rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3));
      target.push_back((T_map_base * p + off).cast<float>());
    }
    map.add(target, Pose());
  }
  [[nodiscard]] Correspondences within(double max_distance) const { return {source, map, max_distance}; }
  [[nodiscard]] Vector3 residual(std::size_t i, const Pose& T) const {
    return T.rotation().conjugate() * (T * source[i].cast<double>() - target[i].cast<double>());
  }
};

Vector6 unit(int axis, double size) { return size * Vector6::Unit(axis); }

TEST(LinearizeRigid, GradientAndHessianAgainstFiniteDifferences) {
  const Pairs pairs;
  constexpr double kScale = 0.7;
  constexpr double kDifference = 1e-6;
  Correspondences within_reach = pairs.within(0.9);
  const auto eq = linearize_rigid(within_reach, pairs.T_map_base, kScale);
  ASSERT_EQ(eq.num_correspondences, 200);
  Vector6 g = Vector6::Zero();
  Matrix6 H = Matrix6::Zero();
  for (std::size_t i = 0; i < pairs.source.size(); ++i) {
    // The residual in the world frame, turned back by the fixed rotation: the weight and frame are held as in
    // IRLS.
    const Matrix3 Rt = pairs.T_map_base.rotation_matrix().transpose();
    Eigen::Matrix<double, 3, 6> J;
    for (int k = 0; k < 6; ++k) {
      const Vector3 p = pairs.source[i].cast<double>();
      J.col(k) = Rt *
                 (pairs.T_map_base * Pose::exp(unit(k, kDifference)) * p -
                  pairs.T_map_base * Pose::exp(unit(k, -kDifference)) * p) /
                 (2.0 * kDifference);
    }
    const Vector3 r = pairs.residual(i, pairs.T_map_base);
    const double w = std::pow(kScale / (kScale + r.squaredNorm()), 2);
    g += w * J.transpose() * r;
    H += w * J.transpose() * J;
  }
  EXPECT_LT((eq.g - g).norm(), 1e-5 * g.norm());
  EXPECT_LT((eq.H - H).norm(), 1e-6 * H.norm());
}

TEST(LinearizeRigid, GradientIsThatOfTheGemanMcClureCost) {
  const Pairs pairs;
  constexpr double kScale = 0.7;
  Correspondences within_reach = pairs.within(0.9);
  const auto eq = linearize_rigid(within_reach, pairs.T_map_base, kScale);
  // rho(r^2) = k r^2 / (k + r^2) / 2 has the derivative w r with w = (k / (k + r^2))^2.
  const auto cost = [&](const Pose& T) {
    double sum = 0.0;
    for (std::size_t i = 0; i < pairs.source.size(); ++i) {
      const double r2 = pairs.residual(i, T).squaredNorm();
      sum += 0.5 * kScale * r2 / (kScale + r2);
    }
    return sum;
  };
  for (int k = 0; k < 6; ++k) {
    const double slope = (cost(pairs.T_map_base * Pose::exp(unit(k, 1e-6))) -
                          cost(pairs.T_map_base * Pose::exp(unit(k, -1e-6)))) /
                         2e-6;
    EXPECT_NEAR(eq.g[k], slope, 1e-4 * eq.g.norm()) << k;
  }
}

TEST(LinearizeUnicycle, GradientAndHessianAgainstFiniteDifferences) {
  const Pairs pairs;
  Correspondences within_reach = pairs.within(0.9);
  const auto eq = linearize_unicycle(within_reach, pairs.T_map_base);
  ASSERT_EQ(eq.num_correspondences, 200);
  const auto at = [&](double d, double theta) {
    return pairs.T_map_base * Pose::exp((Vector6() << d, 0.0, 0.0, 0.0, 0.0, theta).finished());
  };
  const auto cost = [&](const Pose& T) {
    double sum = 0.0;
    for (std::size_t i = 0; i < pairs.source.size(); ++i) sum += 0.5 * pairs.residual(i, T).squaredNorm();
    return sum;
  };
  EXPECT_NEAR(eq.g[0], (cost(at(1e-6, 0)) - cost(at(-1e-6, 0))) / 2e-6, 1e-4 * eq.g.norm());
  EXPECT_NEAR(eq.g[1], (cost(at(0, 1e-6)) - cost(at(0, -1e-6))) / 2e-6, 1e-4 * eq.g.norm());
  Eigen::Matrix2d H = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector3f& point : pairs.source) {
    const Vector3 p = point.cast<double>();
    Eigen::Matrix<double, 3, 2> J;
    J.col(0) = (at(1e-6, 0) * p - at(-1e-6, 0) * p) / 2e-6;
    J.col(1) = (at(0, 1e-6) * p - at(0, -1e-6) * p) / 2e-6;
    H += J.transpose() * J;
  }
  EXPECT_LT((eq.H - H).norm(), 1e-6 * H.norm());
}

struct Built {
  LocalMap map{0.5, 20};
  std::vector<Eigen::Vector3f> source;
};

Built built(const test::Scene& scene, double noise) {
  test::Lidar lidar{64, 512, 0.35, 120.0, noise};
  lidar.jitter = 0.5;
  Built out;
  VoxelThinner thinner;
  for (int i = 0; i < 12; ++i) {
    lidar.seed = static_cast<std::uint64_t>(i);
    const Scan scan = test::scan_of(scene, lidar, Pose(), {}, 0);
    const ThinnedScan thin = thinned_twice(scan.cloud.points, 0.5, thinner);
    out.map.add(thin.map_points, Pose());
    out.source = thin.source;
  }
  return out;
}

TEST(Observability, RoomIsFixedInEveryDirection) {
  const Built scene = built(test::furnished_room(), 0.01);
  const Observability seen = observability(scene.source, scene.map, Pose(), 1.0, 0.01);
  EXPECT_FALSE(seen.degenerate);
  EXPECT_GT(seen.weakest, 0.03);
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(seen.information);
  EXPECT_GT(eigen.eigenvalues()[0], 1e4);  // a centimetre, at the very least
}

TEST(Observability, SmoothTubeIsOpenAlongItsAxis) {
  const Built scene = built(test::smooth_tube(), 0.02);
  const Observability seen = observability(scene.source, scene.map, Pose(), 1.0, 0.01);
  EXPECT_TRUE(seen.degenerate);
  const Vector6 along = Vector6::Unit(0);
  const Vector6 across = Vector6::Unit(1);
  EXPECT_LT(along.dot(seen.information * along), 1e-3 * across.dot(seen.information * across));
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(seen.information);
  EXPECT_NEAR(eigen.eigenvalues()[0], 0.0, 1e-6 * eigen.eigenvalues()[5]);
}

TEST(Observability, NothingSeenIsDegenerateAndKnowsNothing) {
  const Observability seen = observability({}, LocalMap(1.0, 20), Pose(), 1.0, 0.01);
  EXPECT_TRUE(seen.degenerate);
  EXPECT_EQ(seen.information, Matrix6::Zero());
}

TEST(Align, NoCorrespondencesIsAStatusNotANumber) {
  const Pairs pairs;
  const Pose T_far = Pose::translation_of(500.0, 0.0, 0.0);
  for (const Alignment& a : {align_point_to_point(pairs.source, pairs.map, T_far, 0.3, {}),
                             align_unicycle(pairs.source, pairs.map, T_far, 0.9, {}),
                             align_point_to_point({}, pairs.map, T_far, 0.3, {})}) {
    EXPECT_EQ(a.status, StepStatus::too_few_points);
    EXPECT_EQ(a.T_map_base.matrix(), T_far.matrix());
    EXPECT_EQ(a.num_correspondences, 0);
  }
}

TEST(Align, LeavingTheTrustRegionIsDivergence) {
  const Pairs pairs;
  ScanToMapConfig config;
  config.max_correction = 0.01;
  const Pose T_off = pairs.T_map_base * Pose::translation_of(0.2, 0.0, 0.0);
  const Alignment a = align_point_to_point(pairs.source, pairs.map, T_off, 1.0, config);
  EXPECT_EQ(a.status, StepStatus::diverged);
  EXPECT_EQ(a.T_map_base.matrix(), T_off.matrix());
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/scan_to_planes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "adit/core/decompositions.hpp"
#include "adit/odometry/plane_icp.hpp"
#include "support/synthetic_scan.hpp"

namespace adit {
namespace {

struct Scene {
  LocalMap map{0.5, 10};
  std::vector<Eigen::Vector3f> source;
};

/// A room as twelve scans from one place left it, and a thirteenth.
Scene room() {
  test::Lidar lidar{64, 512, 0.35, 120.0, 0.01};
  lidar.jitter = 0.5;
  Scene out;
  VoxelThinner thinner;
  for (int i = 0; i < 13; ++i) {
    lidar.seed = static_cast<std::uint64_t>(i);
    const ThinnedScan thin =
        thinned_twice(test::scan_of(test::furnished_room(), lidar, Pose(), {}, 0).cloud.points, 0.5, thinner);
    if (i < 12) out.map.add(thin.map_points, Pose());
    out.source = thin.source;
  }
  return out;
}

const Matrix6 kHardly = Matrix6::Identity() * 1e-6;

PlaneAlignment aligned(const Scene& scene, const PosePrior& prior,
                       const ScanToMapConfig& config = PlaneIcpConfig().scan_to_map) {
  return align_point_to_plane(scene.source, scene.map, prior, 0.05, config);
}

TEST(PlaneAt, NeitherALineNorAScatterNorTooFewPointsArePlanes) {
  Rng rng(4);
  std::vector<Eigen::Vector3f> wall, line, scatter;
  for (int i = 0; i < 400; ++i) {
    const auto u = static_cast<float>(rng.uniform(-1, 1)), v = static_cast<float>(rng.uniform(-1, 1)),
               w = static_cast<float>(rng.uniform(-1, 1));
    wall.emplace_back(u, v, 0.01F * w);
    line.emplace_back(u + 20, 0.01F * v, 0.01F * w);
    scatter.emplace_back(u + 40, v, w);
  }
  LocalMap map(1.0, 20);
  for (const auto& points : {wall, line, scatter}) map.add(points, Pose());
  const PlaneLimits limits{1.0, 0.1};
  const auto plane = plane_at(map, {0, 0, 0.1F}, limits);
  ASSERT_TRUE(plane.has_value());
  EXPECT_GT(std::abs(plane->normal.z()), 0.999);
  EXPECT_NEAR(plane->point.z(), 0.0, 0.01);
  EXPECT_FALSE(plane_at(map, {20, 0, 0}, limits).has_value());
  EXPECT_FALSE(plane_at(map, {40, 0, 0}, limits).has_value());
  EXPECT_FALSE(plane_at(map, {60, 0, 0}, limits).has_value());
}

TEST(AlignPointToPlane, FindsThePoseFromAPoorPrediction) {
  const Scene scene = room();
  const Pose T_prediction(so3::exp({0.01, -0.02, 0.02}), Vector3(0.1, -0.08, 0.05));
  const PlaneAlignment found = aligned(scene, {T_prediction, kHardly});
  EXPECT_EQ(found.status, StepStatus::ok);
  EXPECT_LT(found.T_map_base.translation().norm(), 0.01);
  EXPECT_LT(found.T_map_base.angle(), 0.001);
  EXPECT_FALSE(found.seen.degenerate);
  EXPECT_GT(found.share_near, 0.5);
}

// A kerb or the foot of a ramp: the planes around the points are not theirs any more.
TEST(AlignPointToPlane, WhereFewPointsLieNearAPlanePointToPointComesFirst) {
  const Scene scene = room();
  const Pose T_prediction(so3::exp({0.0, 0.2, 0.0}), Vector3(0.0, 0.0, 0.5));
  const double usual = aligned(scene, {Pose(), kHardly}).share_near;
  const auto error = [&](double usual_share) {
    return aligned(scene, {T_prediction, kHardly, usual_share}).T_map_base.angle();
  };
  EXPECT_LT(error(usual), 0.002);
  EXPECT_GT(error(0.0), 5.0 * error(usual));
}

TEST(AlignPointToPlane, WithoutPlanesNothingWasMatched) {
  const Pose T_prediction = Pose::planar(1.0, 2.0, 0.3);
  const PlaneAlignment found =
      aligned({.source = room().source}, {T_prediction, inverse(wheel_covariance({}, {}))});
  EXPECT_EQ(found.status, StepStatus::too_few_points);
  EXPECT_EQ(found.num_correspondences, 0);
  EXPECT_EQ(found.T_map_base.matrix(), T_prediction.matrix());
  EXPECT_EQ(found.seen.information, Matrix6::Zero());
}

TEST(AlignPointToPlane, ATubeLeavesOneDirectionOpenAndMatches) {
  Scene scene;
  test::Lidar lidar{64, 512, 0.35, 120.0, 0.01};
  lidar.jitter = 0.5;
  VoxelThinner thinner;
  for (int i = 0; i < 13; ++i) {
    lidar.seed = static_cast<std::uint64_t>(i);
    const Scan scan = test::scan_of(test::smooth_tube(), lidar, Pose(), {}, 0);
    const ThinnedScan thin = thinned_twice(scan.cloud.points, 0.5, thinner);
    if (i < 12) scene.map.add(thin.map_points, Pose());
    scene.source = thin.source;
  }
  const Pose T_prediction = Pose::translation_of(0.3, 0.05, 0.0);
  const PlaneAlignment found =
      aligned(scene, {T_prediction, inverse(wheel_covariance({}, Pose::translation_of(0.3, 0, 0)))});
  EXPECT_EQ(found.status, StepStatus::ok);
  EXPECT_TRUE(found.seen.degenerate);
  EXPECT_NEAR(found.T_map_base.translation().x(), 0.3, 0.02);  // nothing is known along the axis
  EXPECT_NEAR(found.T_map_base.translation().y(), 0.0, 0.01);
}

TEST(LinearizePrior, IsTheDerivativeOfItsCost) {
  Rng rng(6);
  const Pose T_prior(so3::exp({0.3, -0.2, 1.1}), Vector3(4.0, -2.0, 0.5));
  const Pose T_map_base = T_prior * Pose(so3::exp({0.4, -0.7, 0.6}), Vector3(0.8, -1.5, 0.4));
  Matrix6 root;
  for (double& value : root.reshaped()) value = rng.normal();
  const PosePrior prior{T_prior, root * root.transpose()};
  const auto cost = [&](const Vector6& step) {
    const Vector6 off = (T_prior.inverse() * T_map_base * Pose::exp(step)).log();
    return 0.5 * off.dot(prior.information * off);
  };
  const ScanEquations<6> equations = linearize_prior(prior, T_map_base);
  for (int k = 0; k < 6; ++k) {
    const Vector6 step = 1e-6 * Vector6::Unit(k);
    EXPECT_NEAR((cost(step) - cost(-step)) / 2e-6, equations.g[k], 1e-6 * equations.g.norm()) << k;
  }
  EXPECT_EQ(equations.num_correspondences, 0);
}

// The weighted mean of two measurements: where the prior is as strong as the scan, the pose lies half way.
TEST(AlignPointToPlane, ThePriorAndTheScanCountByTheirInformation) {
  const Scene scene = room();
  const Vector3 off(0.0, 0.02, 0.0);
  const Pose T_prediction(so3::exp({0.0, 0.0, 0.0}), off);
  const auto share_of_the_prior = [&](double information) {
    Matrix6 all = Matrix6::Identity() * 1e12;  // what is not asked about stays
    all(1, 1) = information;
    return aligned(scene, {T_prediction, all}).T_map_base.translation().y() / off.y();
  };
  const double with_1e5 = share_of_the_prior(1e5);
  ASSERT_GT(with_1e5, 0.1);
  ASSERT_LT(with_1e5, 0.9);
  const double of_the_scan = 1e5 * (1.0 - with_1e5) / with_1e5;
  EXPECT_NEAR(share_of_the_prior(of_the_scan), 0.5, 0.02);
  EXPECT_NEAR(share_of_the_prior(4.0 * of_the_scan), 0.8, 0.02);
  EXPECT_LT(share_of_the_prior(1e-3 * of_the_scan), 0.05);
}

TEST(AlignPointToPlane, ATurnBeyondTheBoundIsDivergenceToo) {
  const Scene scene = room();
  ScanToMapConfig config = PlaneIcpConfig().scan_to_map;
  config.max_turn_deg = 2.0;
  const Pose T_prediction =
      Pose::planar(0.0, 0.0, 0.05);  // 2.9 degrees: half a metre at the 10 m of the room
  EXPECT_EQ(aligned(scene, {T_prediction, kHardly}, config).status, StepStatus::diverged);
  config.max_turn_deg = 3.5;
  EXPECT_EQ(aligned(scene, {T_prediction, kHardly}, config).status, StepStatus::ok);
}

TEST(AlignPointToPlane, ACorrectionBeyondTheBoundIsDivergence) {
  const Scene scene = room();
  ScanToMapConfig config = PlaneIcpConfig().scan_to_map;
  config.max_correction = 0.02;
  const Pose T_prediction = Pose::translation_of(0.1, -0.08, 0.05);
  const PlaneAlignment found = aligned(scene, {T_prediction, kHardly}, config);
  EXPECT_EQ(found.status, StepStatus::diverged);
  EXPECT_EQ(found.T_map_base.matrix(), T_prediction.matrix());
}

}  // namespace
}  // namespace adit

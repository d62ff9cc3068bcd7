// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/scan_to_planes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

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

TEST(WheelInformation, IsThatOfADistributionEvenAtRest) {
  for (const Pose& motion : {Pose(), Pose::planar(0.2, 0.0, 0.05), Pose::translation_of(3.0, 0.0, 0.0)}) {
    const Matrix6 information = wheel_information({}, motion);
    EXPECT_TRUE(information.allFinite());
    EXPECT_EQ(information.llt().info(), Eigen::Success);
  }
  const Matrix6 near = wheel_information({}, Pose::translation_of(0.1, 0, 0));
  const Matrix6 far = wheel_information({}, Pose::translation_of(1.0, 0, 0));
  for (int k = 0; k < 6; ++k) EXPECT_LT(far(k, k), near(k, k)) << k;
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
  const Pose T_prediction(so3::exp({0.0, 0.14, 0.0}), Vector3(0.0, 0.0, 0.1));
  const double usual = aligned(scene, {Pose(), kHardly}).share_near;
  const auto error = [&](double usual_share) {
    return aligned(scene, {T_prediction, kHardly, usual_share}).T_map_base.angle();
  };
  EXPECT_LT(error(usual), 0.002);
  EXPECT_GT(error(0.0), 5.0 * error(usual));
}

TEST(AlignPointToPlane, WithoutPlanesTheWheelsDecideAndNothingIsKnown) {
  const Pose T_prediction = Pose::planar(1.0, 2.0, 0.3);
  const PlaneAlignment found =
      aligned({.source = room().source}, {T_prediction, wheel_information({}, Pose())});
  EXPECT_LT((T_prediction.inverse() * found.T_map_base).log().norm(), 1e-9);
  EXPECT_TRUE(found.seen.degenerate);
  EXPECT_EQ(found.seen.information, Matrix6::Zero());
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

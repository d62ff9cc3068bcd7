// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/distinctive_stretch.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "adit/evaluation/shared_stretch.hpp"
#include "adit/simulation/scenario.hpp"
#include "adit/study/surface_fit.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

/// Two metres long, as high as the tunnel.
struct Niche {
  double x = 0.0;
  double side = 1.0;  ///< 1: left of who drives along x.
  double depth = 1.5;
};

/// A tunnel of 5 x 4 m along x from -30 to 150 m with its middle at y = `middle`, floor at z = 0. Its ends
/// are open.
TriangleMesh tunnel(const std::vector<Niche>& niches, double middle = 0.0) {
  constexpr double kHalfWidth = 2.5;
  constexpr double kHeight = 4.0;
  TriangleMesh mesh;
  for (const double side : {1.0, -1.0}) {
    const auto wall_at = [&](double x) {
      for (const Niche& niche : niches)
        if (niche.side == side && x >= niche.x - 1.0 && x < niche.x + 1.0) return kHalfWidth + niche.depth;
      return kHalfWidth;
    };
    const auto at = [&](double x, double y, double z) { return Vector3(x, middle + side * y, z); };
    for (double x = -30.0; x < 150.0; x += 1.0) {
      const double y = wall_at(x + 0.5);
      const double next = wall_at(x + 1.5);
      test::add_quad(mesh, at(x, y, 0), at(x + 1, y, 0), at(x + 1, y, kHeight), at(x, y, kHeight));
      test::add_quad(mesh, at(x, 0, 0), at(x + 1, 0, 0), at(x + 1, y, 0), at(x, y, 0));
      test::add_quad(mesh, at(x, 0, kHeight), at(x + 1, 0, kHeight), at(x + 1, y, kHeight),
                     at(x, y, kHeight));
      if (y != next)
        test::add_quad(mesh, at(x + 1, y, 0), at(x + 1, next, 0), at(x + 1, next, kHeight),
                       at(x + 1, y, kHeight));
    }
  }
  return mesh;
}

Raycaster cast(const TriangleMesh& mesh) { return Raycaster::build(mesh, EdgeRule::watertight).value(); }

/// From x = `begin` to `end`, a pose every 0.2 m, on a lane beside the middle.
Trajectory drive(double begin, double end, double y) {
  Trajectory truth;
  const double sign = end > begin ? 1.0 : -1.0;
  const auto num = static_cast<int>(std::abs(end - begin) / 0.2);
  for (int i = 0; i <= num; ++i)
    truth.push_back({Stamp{i * 100'000'000LL},
                     Pose::planar(begin + sign * 0.2 * i, y, sign > 0.0 ? 0.0 : std::numbers::pi)});
  return truth;
}

/// Of two robots on lanes of their own, in opposite directions.
double metres_in(const TriangleMesh& mesh, const std::vector<Trajectory>& others = {}) {
  // Not from a whole metre, where rays would run exactly along the faces of niches.
  std::vector<Trajectory> truths = {drive(0.37, 120.37, 0.8), drive(120.3, 0.3, -0.7)};
  truths.insert(truths.end(), others.begin(), others.end());
  const DistinctiveMetres metres = distinctive_stretches(cast(mesh), truths);
  EXPECT_EQ(metres[0][0], 0.0);
  EXPECT_EQ(metres[0][1], metres[1][0]);
  return metres[0][1];
}

TEST(DistinctiveStretch, ASmoothTubeHasNone) { EXPECT_EQ(metres_in(tunnel({})), 0.0); }

TEST(DistinctiveStretch, ANicheMakesTheStretchesAroundIt) {
  const double metres = metres_in(tunnel({{50.0}}));
  EXPECT_GE(metres, kDistinctiveStretch);
  EXPECT_LE(metres, 2.0 * kDistinctiveStretch + 10.0);
}

TEST(DistinctiveStretch, TwoNichesAlikeMakeNoneUnlessWhatIsAroundThemDiffers) {
  EXPECT_EQ(metres_in(tunnel({{30.0}, {90.0}})), 0.0);
  EXPECT_GE(metres_in(tunnel({{30.0}, {42.0}, {90.0}})), kDistinctiveStretch);
}

TEST(DistinctiveStretch, OfTwoNichesOnOppositeSidesEachIsTheOtherToWhoTurnsRound) {
  EXPECT_EQ(metres_in(tunnel({{30.0, 1.0}, {90.0, -1.0}})), 0.0);
  EXPECT_GE(metres_in(tunnel({{30.0, 1.0}, {90.0, -1.0, 0.9}})), kDistinctiveStretch);
}

TEST(DistinctiveStretch, ACopyThatAnotherRobotDroveLeavesNone) {
  const std::vector<Niche> niches = {{30.0}, {41.0, -1.0}, {75.0}};
  EXPECT_GE(metres_in(tunnel(niches)), kDistinctiveStretch);
  TriangleMesh both = tunnel(niches);
  append(both, tunnel(niches, 200.0));
  EXPECT_GE(metres_in(both), kDistinctiveStretch) << "no robot was in the copy";
  EXPECT_EQ(metres_in(both, {drive(119.6, -0.2, 200.9)}), 0.0);
}

TEST(DistinctiveStretch, WhatSensorsMayErrByTellsNothing) {
  EXPECT_EQ(metres_in(tunnel({{50.0, 1.0, 0.1}})), 0.0);
  EXPECT_GE(metres_in(tunnel({{50.0, 1.0, 0.4}})), kDistinctiveStretch);
}

TEST(DistinctiveStretch, CountsOnlyWhereBothDrove) {
  const Raycaster world = cast(tunnel({{50.0}}));
  const auto metres = [&](const Trajectory& a, const Trajectory& b) {
    return distinctive_stretches(world, {a, b})[0][1];
  };
  EXPECT_EQ(metres(drive(0.37, 120.37, 0), drive(80, 120, 0)), 0.0) << "the niche is not on the shared part";
  EXPECT_EQ(metres(drive(0.37, 120.37, 0), drive(45, 60, 0)), 0.0) << "too short";
  EXPECT_GE(metres(drive(0.37, 120.37, 0), drive(35, 80, 0)), kDistinctiveStretch);
  EXPECT_EQ(metres(drive(0.37, 120.37, 0), {}), 0.0);
  EXPECT_EQ(metres(drive(0.37, 120.37, 0), drive(50, 50.4, 0)), 0.0);
  EXPECT_TRUE(distinctive_stretches(world, {}).empty());
}

TEST(DistinctiveStretch, WorldsThatAreTwinsToTheLastBitHaveNone) {
  WorldConfig config;
  config.preset = "tiles";
  config.arrangement = "twins";
  const Result<World> world = make_world(config);
  ASSERT_TRUE(world) << world.error().message;
  const auto recordings = simulate(*world, {});  // casts no scan before one is read
  ASSERT_TRUE(recordings) << recordings.error().message;
  std::vector<Trajectory> truths;
  for (const Recording& recording : *recordings) truths.push_back(recording.truth);
  EXPECT_GT(shared_stretch_m(truths[0], truths[1]), kMergeableStretch);
  for (const std::vector<double>& row : distinctive_stretches(cast(world->mesh), truths))
    for (const double metres : row) EXPECT_EQ(metres, 0.0);
}

TEST(SurfacePath, HalfATurnPutsRaysOnRays) {
  for (std::size_t ray = 0; ray < kRays; ++ray) {
    const Eigen::Vector3f& d = ray_directions()[ray];
    const Eigen::Vector3f turned(-d.x(), -d.y(), d.z());
    EXPECT_NEAR((turned - ray_directions()[turned_ray(ray)]).norm(), 0.0F, 1e-5F) << ray;
    EXPECT_EQ(turned_ray(turned_ray(ray)), ray);
  }
}

TEST(SurfacePath, IsCentredWhateverTheLane) {
  const Raycaster world = cast(tunnel({{50.0}}));
  const auto one = surface_along(world, drive(0, 120, 1.5));
  const auto other = surface_along(world, drive(0, 120, -1.0));
  ASSERT_EQ(one.size(), 121U);
  ASSERT_EQ(other.size(), one.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_NEAR(one[i].T_world_view.translation().y(), 0.0, 1e-5) << i;
    EXPECT_NEAR((one[i].T_world_view.inverse() * other[i].T_world_view).log().norm(), 0.0, 1e-5) << i;
  }
}

TEST(FitSurface, FindsTheAlignmentThatOnlyANicheFixes) {
  const Raycaster world = cast(tunnel({{30.0}, {90.0}}));
  const auto samples = surface_along(world, drive(0.37, 120.37, 0));
  const std::span<const SurfaceSample> stretch = std::span(samples).subspan(22, 21);
  const SurfaceFit home = fit_surface(world, stretch, Pose::planar(0.4, 0.3, 0.002));
  EXPECT_LT(home.differing, 0.001);
  EXPECT_LT((home.T_there_here * Vector3(32, 0, 1) - Vector3(32, 0, 1)).norm(), 0.02);
  const SurfaceFit away = fit_surface(world, stretch, Pose::planar(60.4, 0.3, 0.002));
  EXPECT_LT(away.differing, 0.001);
  EXPECT_LT((away.T_there_here * Vector3(32, 0, 1) - Vector3(92, 0, 1)).norm(), 0.02);
  EXPECT_GT(fit_surface(world, stretch, Pose::planar(30.0, 0.0, 0.0)).differing, 0.01) << "no niche there";
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/surface_signal.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "adit/core/angles.hpp"
#include "adit/simulation/lidar_model.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

Surfaces of_contrast(double contrast, std::uint64_t seed = 3) {
  SurfaceConfig config;
  config.contrast = contrast;
  return {config, seed};
}

RayBlock ending_at(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& origin) {
  RayBlock rays;
  rays.size = points.size();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f way = points[i] - origin;
    rays.origins.x[i] = origin.x();
    rays.origins.y[i] = origin.y();
    rays.origins.z[i] = origin.z();
    rays.directions.x[i] = way.x() / way.norm();
    rays.directions.y[i] = way.y() / way.norm();
    rays.directions.z[i] = way.z() / way.norm();
    rays.distances[i] = way.norm();
    rays.cosines[i] = 1.0F;
  }
  return rays;
}

std::vector<float> reflectivities_at(const Surfaces& surfaces, const std::vector<Eigen::Vector3f>& points,
                                     const Eigen::Vector3f& origin) {
  RayBlock::Numbers out;
  surfaces.reflectivities(ending_at(points, origin), out);
  return {out.begin(), out.begin() + static_cast<std::ptrdiff_t>(points.size())};
}

std::vector<Eigen::Vector3f> places() {
  std::vector<Eigen::Vector3f> out;
  for (int i = 0; i < 100; ++i) out.emplace_back(7.3F * static_cast<float>(i), 0.9F, 0.4F);
  return out;
}

TEST(Surfaces, AreSeenAlikeFromEverywhere) {
  const auto here = reflectivities_at(of_contrast(1.0), places(), {0, 0, 1});
  EXPECT_EQ(here, reflectivities_at(of_contrast(1.0), places(), {300, -2, 1.5F}));
  EXPECT_NE(here, reflectivities_at(of_contrast(1.0, 4), places(), {0, 0, 1}));
}

TEST(Surfaces, RangeFromCoalToConcrete) {
  const auto found = reflectivities_at(of_contrast(1.0), places(), {0, 0, 1});
  EXPECT_GE(*std::ranges::min_element(found), 0.05F);
  EXPECT_LE(*std::ranges::max_element(found), 0.6F);
  const auto dark = std::ranges::count_if(found, [](float r) { return r < 0.2F; });
  EXPECT_GT(dark, 30);
  EXPECT_LT(dark, 70);
  for (const float alike : reflectivities_at(of_contrast(0.0), places(), {0, 0, 1})) EXPECT_EQ(alike, 0.1F);
}

TEST(Surfaces, HaveSignsAsOftenAsTold) {
  SurfaceConfig config;
  config.contrast = 1.0;
  config.signs = 0.3;
  const auto found = reflectivities_at({config, 3}, places(), {0, 0, 1});
  const auto num = std::ranges::count(found, 0.9F);
  EXPECT_GT(num, 15);
  EXPECT_LT(num, 45);
}

TEST(Surfaces, ChangeBetweenVisits) {
  SurfaceConfig config;
  config.contrast = 1.0;
  const auto logs = [&](const Surfaces& surfaces) {
    std::vector<double> out;
    for (const float r : reflectivities_at(surfaces, places(), {0, 0, 1}))
      out.push_back(std::log10(static_cast<double>(r)));
    return out;
  };
  const std::vector<double> before = logs({config, 3});
  EXPECT_EQ(logs(Surfaces(config, 3).on_visit(1)), before) << "nothing changes";
  config.visit_change = 0.2;
  const std::vector<double> first = logs(Surfaces(config, 3).on_visit(1));
  EXPECT_EQ(first, logs(Surfaces(config, 3).on_visit(1)));
  EXPECT_NE(first, logs(Surfaces(config, 3).on_visit(2)));
  double squares = 0.0;
  for (std::size_t i = 0; i < first.size(); ++i) squares += std::pow(first[i] - before[i], 2);
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(first.size())), 0.2, 0.04);
}

TEST(Surfaces, OfSomeWorldsAreMoreEven) {
  SurfaceConfig config;
  config.contrast = 1.0;
  config.evenness = 0.75;
  double least = 1.0;
  double most = 0.0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const auto found = reflectivities_at({config, seed}, places(), {0, 0, 1});
    const double tenfold = std::log10(std::ranges::max(found) / std::ranges::min(found));
    least = std::min(least, tenfold);
    most = std::max(most, tenfold);
  }
  EXPECT_LT(least, 0.5);
  EXPECT_GT(least, 0.2) << "a quarter of a factor of twelve";
  EXPECT_GT(most, 0.9);
}

TEST(Signal, FallsAsTheLidarEquationSays) {
  RayBlock rays = ending_at({{50, 0, 0}, {100, 0, 0}, {50, 0, 0}}, {0, 0, 0});
  rays.cosines[2] = 0.5F;
  RayBlock::Numbers reflectivities;
  reflectivities.fill(0.1F);
  RayBlock::Numbers signals;
  add_signals(rays, reflectivities, 100.0F, signals);
  EXPECT_FLOAT_EQ(signals[0], 4.0F);
  EXPECT_FLOAT_EQ(signals[1], 1.0F);
  EXPECT_FLOAT_EQ(signals[2], 2.0F);
}

double share_kept(float signal) {
  std::size_t kept = 0;
  constexpr std::size_t kBlocks = 40;
  for (std::uint64_t seed = 0; seed < kBlocks; ++seed) {
    RayBlock rays = ending_at(places(), {0, 0, 1});
    RayBlock::Numbers signals;
    signals.fill(signal);
    drop_weak(signals, seed, rays);
    kept += static_cast<std::size_t>(std::count_if(rays.distances.begin(), rays.distances.begin() + 100,
                                                   [](float d) { return d < RayHit::kMiss; }));
  }
  return static_cast<double>(kept) / (100.0 * kBlocks);
}

TEST(Signal, WeakReturnsGetLost) {
  EXPECT_EQ(share_kept(0.49F), 0.0);
  EXPECT_NEAR(share_kept(0.75F), 0.25, 0.03);
  EXPECT_NEAR(share_kept(1.0F), 0.5, 0.03);
  EXPECT_EQ(share_kept(1.51F), 1.0);
}

TEST(Signal, WeakReturnsAreLate) {
  EXPECT_FLOAT_EQ(share_of_walk(100.0F), 0.5F);
  EXPECT_LT(share_of_walk(1e4F), 0.1F);
  EXPECT_GT(share_of_walk(1.0F), 0.9F);
}

/// Rays from 1 m above the floor that meet it at 20 m, and then the wall at 30 m.
RayBlock grazing(std::size_t num) {
  std::vector<Eigen::Vector3f> ends;
  for (std::size_t i = 0; i < num; ++i) ends.emplace_back(20.0F, 1e-3F * static_cast<float>(i), 0.0F);
  return ending_at(ends, {0, 0, 1});
}

TEST(WetFloor, ShowsTheWallBelowTheFloor) {
  const Raycaster world = Raycaster::build(test::room({-10, -10, 0}, {30, 10, 6})).value();
  SurfaceConfig config;
  config.wet = 1.0;
  const Surfaces wet(config, 3);
  std::size_t mirrored = 0;
  constexpr std::size_t kRays = 100;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    RayBlock rays = grazing(kRays);
    world.cast(rays, 100.0F);
    const RayBlock dry = rays;
    wet.mirror(world, 100.0F, seed, rays);
    for (std::size_t i = 0; i < kRays; ++i) {
      if (rays.distances[i] == dry.distances[i]) continue;
      ++mirrored;
      EXPECT_NEAR(rays.distances[i] * rays.directions.x[i], 30.0F, 0.01F);  // the wall
      EXPECT_NEAR(1.0F + rays.distances[i] * rays.directions.z[i], -0.5F,
                  0.01F);  // half a metre up, mirrored
    }
  }
  const double cosine = 1.0 / std::hypot(20.0, 1.0);
  const double fresnel = 0.02 + 0.98 * std::pow(1.0 - cosine, 5);
  EXPECT_NEAR(static_cast<double>(mirrored) / (20.0 * kRays), fresnel, 0.04);
}

TEST(WetFloor, LosesWhatGoesIntoTheOpenAndLeavesWalls) {
  const TriangleMesh floor = test::floor_of({Eigen::Vector2d(-10, -10), Eigen::Vector2d(30, 10)}, 5.0,
                                            [](double, double) { return 0.0; });
  const Raycaster open = Raycaster::build(floor).value();
  SurfaceConfig config;
  config.wet = 1.0;
  RayBlock rays = grazing(100);
  open.cast(rays, 100.0F);
  Surfaces(config, 3).mirror(open, 100.0F, 1, rays);
  EXPECT_GT(std::count(rays.distances.begin(), rays.distances.begin() + 100, RayHit::kMiss), 50);
  TriangleMesh wall;  // as grazed as the floor, but upright
  test::add_quad(wall, {-10, -1, -9}, {90, -1, -9}, {90, -1, 9}, {-10, -1, 9});
  const Raycaster upright = Raycaster::build(wall).value();
  RayBlock beside = ending_at({{20, -1, -0.2F}, {25, -1, -0.3F}}, {0, 0, 0});
  upright.cast(beside, 100.0F);
  const RayBlock before = beside;
  for (std::uint64_t seed = 0; seed < 20; ++seed) Surfaces(config, 3).mirror(upright, 100.0F, seed, beside);
  EXPECT_EQ(beside.distances[0], before.distances[0]);
  EXPECT_EQ(beside.distances[1], before.distances[1]);
}

LidarConfig one_beam() {
  LidarConfig c;
  c.beams = 1;
  c.elevation_min_deg = c.elevation_max_deg = 0.0;
  return c;
}

/// Ranges in a square room whose walls are `half` metres away.
PointCloud cloud_in_a_room(double half, double contrast, const LidarUnit& unit = {}) {
  const Raycaster world = Raycaster::build(test::room({-half, -half, -5}, {half, half, 5})).value();
  Sweep sweep{Pose(), Pose(), Stamp{1'000'000'000}, 1};
  sweep.surfaces = of_contrast(contrast);
  return cast_scan(world, one_beam(), sweep, unit).cloud;
}

double spread_of_walls(const PointCloud& cloud, double half) {
  double squares = 0.0;
  for (const Eigen::Vector3f& p : cloud.points)
    squares += std::pow(static_cast<double>(p.head<2>().cwiseAbs().maxCoeff()) - half, 2);
  return std::sqrt(squares / static_cast<double>(cloud.size()));
}

TEST(Signal, BringsIntensityAndNoiseToAScan) {
  EXPECT_TRUE(cloud_in_a_room(20.0, 0.0).intensities.empty());
  const PointCloud cloud = cloud_in_a_room(20.0, 1.0);
  ASSERT_EQ(cloud.intensities.size(), cloud.size());
  EXPECT_LT(*std::ranges::max_element(cloud.intensities), 65.0F);  // 60 %, head-on, and its noise
  EXPECT_GT(*std::ranges::max_element(cloud.intensities), 20.0F);
  EXPECT_GT(*std::ranges::min_element(cloud.intensities), 2.0F);  // 5 % at 60 degrees at most
  EXPECT_GT(spread_of_walls(cloud_in_a_room(120.0, 1.0), 120.0), 1.2 * spread_of_walls(cloud, 20.0));
  EXPECT_LT(cloud_in_a_room(190.0, 1.0).size(), cloud.size());  // dark walls return too little there
}

TEST(Signal, IsReportedAsTheUnitDoes) {
  LidarUnit unit;
  unit.response = 0.5;
  unit.fall_off = 1.0;
  const PointCloud plain = cloud_in_a_room(20.0, 1.0);
  const PointCloud raw = cloud_in_a_room(20.0, 1.0, unit);
  ASSERT_EQ(raw.size(), plain.size());
  for (std::size_t i = 0; i < raw.size(); ++i)
    EXPECT_NEAR(raw.intensities[i], std::sqrt(plain.intensities[i]) * raw.points[i].norm() / 10.0F, 0.6F);
}

TEST(Signal, WalksWithIntensity) {
  LidarUnit unit;
  unit.intensity_walk = 0.03;
  const PointCloud walked = cloud_in_a_room(40.0, 1.0, unit);
  const PointCloud plain = cloud_in_a_room(40.0, 1.0);
  ASSERT_EQ(walked.size(), plain.size());
  double least = 1.0;
  double most = 0.0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const double walk = static_cast<double>(walked.points[i].norm() - plain.points[i].norm());
    least = std::min(least, walk);
    most = std::max(most, walk);
  }
  EXPECT_GT(least, 0.0);
  EXPECT_LT(most, 0.03);
  EXPECT_GT(most - least, 0.005);  // dark patches beside bright ones
}

}  // namespace
}  // namespace adit

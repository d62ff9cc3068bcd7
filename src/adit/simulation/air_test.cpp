// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/air.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "adit/simulation/lidar_model.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

constexpr std::size_t kRays = 128;
constexpr float kReach = 200.0F;

/// All along x, ending at a wall that returns that signal.
struct Looked {
  RayBlock rays;
  RayBlock::Numbers signals;
};
Looked looked(const Air& air, float wall, float signal, std::uint64_t seed) {
  Looked out;
  out.rays.size = kRays;
  out.rays.origins.x.fill(0.0F);
  out.rays.origins.y.fill(0.0F);
  out.rays.origins.z.fill(0.0F);
  out.rays.directions.x.fill(1.0F);
  out.rays.directions.y.fill(0.0F);
  out.rays.directions.z.fill(0.0F);
  out.rays.distances.fill(wall);
  out.rays.cosines.fill(0.7F);
  out.signals.fill(signal);
  look_through(air, kReach, seed, out.rays, out.signals);
  return out;
}

/// The ranges of returns from before the wall.
std::vector<float> ranges_in_air(const Air& air, float wall, float signal) {
  std::vector<float> out;
  for (std::uint64_t seed = 0; seed < 100; ++seed)
    for (const float range : looked(air, wall, signal, seed).rays.distances)
      if (range < wall) out.push_back(range);
  return out;
}
constexpr double kAllRays = 100.0 * kRays;

TEST(Air, FogWeakensWhatLiesBehind) {
  Air air;
  air.fog = 0.01F;
  const Looked out = looked(air, 40.0F, 1e6F, 1);
  for (std::size_t i = 0; i < kRays; ++i) {
    EXPECT_EQ(out.rays.distances[i], 40.0F);  // the wall is stronger by far
    EXPECT_NEAR(out.signals[i], 1e6F * std::exp(-0.8F), 1.0F);
  }
}

TEST(Air, FogReturnsAreSpreadAndMoreOfThemAreNear) {
  Air air;
  air.fog = 0.02F;
  const std::vector<float> found = ranges_in_air(air, 40.0F, 100.0F);
  const double scattered = 1.0 - std::exp(-0.02 * 40.0);
  EXPECT_GT(static_cast<double>(found.size()), 0.01 * kAllRays);
  EXPECT_LT(static_cast<double>(found.size()), scattered * kAllRays);
  const auto up_to = [&](float range) {
    return std::ranges::count_if(found, [&](float r) { return r < range; });
  };
  EXPECT_GT(up_to(5.0F), std::ranges::count_if(found, [](float r) { return r > 5.0F && r < 10.0F; }));
  EXPECT_GT(*std::ranges::max_element(found), 8.0F);
}

TEST(Air, ADenseCloudHasASkin) {
  Air air;
  air.balls.push_back({{15.0F, 0.0F, 0.0F}, 5.0F, 3.0F});
  std::size_t in_skin = 0;
  std::size_t seen_wall = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Looked out = looked(air, 40.0F, 100.0F, seed);
    drop_weak(out.signals, seed, out.rays);
    for (std::size_t i = 0; i < kRays; ++i) {
      EXPECT_GT(out.rays.distances[i], 9.99F);
      in_skin += out.rays.distances[i] < 11.5F ? 1 : 0;
      seen_wall += out.rays.distances[i] == 40.0F ? 1 : 0;
    }
  }
  EXPECT_GT(in_skin, 10 * kRays / 2);
  EXPECT_EQ(seen_wall, 0U);  // an optical depth of 30
}

TEST(Air, ACloudBesideTheRayOrBehindTheWallDoesNothing) {
  Air air;
  air.balls.push_back({{15.0F, 6.0F, 0.0F}, 5.0F, 3.0F});
  air.balls.push_back({{50.0F, 0.0F, 0.0F}, 5.0F, 3.0F});
  air.balls.push_back({{-10.0F, 0.0F, 0.0F}, 5.0F, 3.0F});
  EXPECT_TRUE(ranges_in_air(air, 40.0F, 100.0F).empty());
  EXPECT_EQ(looked(air, 40.0F, 100.0F, 1).signals[3], 100.0F);
}

TEST(Air, DropsAreAsManyAsTold) {
  Air air;
  air.drips = 0.02F;
  const std::vector<float> found = ranges_in_air(air, 40.0F, 100.0F);
  EXPECT_NEAR(static_cast<double>(found.size()) / kAllRays, 0.02, 0.005);
  EXPECT_LT(*std::ranges::max_element(found), 9.0F);
}

Trajectory straight_path() {
  Trajectory out;
  for (int i = 0; i <= 2000; ++i) out.push_back({Stamp{i * 500'000'000LL}, Pose::planar(i, 0.0, 0.0)});
  return out;
}

TEST(Air, CloudsComeAndGoWhereARobotDrives) {
  AirConfig config;
  config.clouds_per_km = 5.0;
  const Trajectory path = straight_path();
  const std::vector<DustCloud> clouds = draw_clouds(path, config, 3);
  ASSERT_FALSE(clouds.empty());
  std::size_t num = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) num += draw_clouds(path, config, seed).size();
  EXPECT_NEAR(static_cast<double>(num) / 40.0, 10.0, 1.5);
  for (const DustCloud& cloud : clouds) {
    const Pose met = *pose_at(path, cloud.middle);
    EXPECT_LT((met.translation() - cloud.centre).norm(), 6.0);
    EXPECT_GE(cloud.density, config.cloud_density / 4.0);
    EXPECT_LE(cloud.density, config.cloud_density * 4.0);
    const Air then = air_at(cloud.middle, met.translation(), config, {cloud}, 1);
    ASSERT_EQ(then.balls.size(), 1U);
    EXPECT_LT((then.balls[0].centre.cast<double>() - cloud.centre).norm(), 1e-3);
    EXPECT_TRUE(air_at(cloud.middle + from_seconds(60.0), met.translation(), config, {cloud}, 1).is_clear());
  }
}

TEST(Air, WaterDripsInSomePlacesForAll) {
  AirConfig config;
  config.drips = 0.01;
  int dripping = 0;
  for (int i = 0; i < 200; ++i) {
    const Vector3 place(10.0 * i + 3.0, 2.0, 1.0);
    const bool drips = air_at(Stamp{}, place, config, {}, 5).drips > 0.0F;
    EXPECT_EQ(drips, air_at(Stamp{7}, place + Vector3(4.0, 0.0, 0.0), config, {}, 5).drips > 0.0F);
    dripping += drips ? 1 : 0;
  }
  EXPECT_NEAR(dripping, 60, 25);
}

TEST(Air, ClearAirLeavesAScanAsItIs) {
  const Raycaster room = Raycaster::build(test::room({-9, -9, -2}, {9, 9, 3})).value();
  const LidarConfig lidar = lidar_preset("os2-32").value();
  Sweep sweep{Pose(), Pose(), Stamp{1'000'000'000}, 1};
  const PointCloud clear = cast_scan(room, lidar, sweep).cloud;
  sweep.air.fog = 1e-9F;
  EXPECT_EQ(cast_scan(room, lidar, sweep).cloud.points, clear.points);
  sweep.air.fog = 0.1F;
  EXPECT_NE(cast_scan(room, lidar, sweep).cloud.points, clear.points);
}

}  // namespace
}  // namespace adit

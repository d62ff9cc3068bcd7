// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/visit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "adit/simulation/scenario.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

constexpr double kLength = 400.0;
constexpr std::size_t kVerticesOfAThing = 6 * 8;  // body, cabin, four wheels

Raycaster hall(double width) {
  return Raycaster::build(test::room({-5.0, -width / 2.0, 0.0}, {kLength + 5.0, width / 2.0, 5.0}),
                          EdgeRule::watertight)
      .value();
}

/// Along the middle of the hall, there or back.
Trajectory path(bool back) {
  Trajectory out;
  for (int i = 0; i <= 4 * static_cast<int>(kLength); ++i) {
    const double x = 0.25 * i;
    out.push_back({Stamp{i * 100'000'000LL},
                   back ? Pose::planar(kLength - x, 0.5, 3.14159) : Pose::planar(x, -0.5, 0.0)});
  }
  return out;
}

std::vector<TriangleMesh> parked(double width, double changed, std::uint64_t seed = 3) {
  VisitConfig config;
  config.vehicles_per_km = 30.0;
  config.pallets_per_km = 20.0;
  config.changed = changed;
  return parked_things(hall(width), std::vector{path(false), path(true)}, config, seed);
}

std::size_t num_things(const TriangleMesh& mesh) { return mesh.vertices.size() / kVerticesOfAThing; }

TEST(Visit, ThingsStandAtTheWallsAndLeaveRoom) {
  for (const TriangleMesh& mesh : parked(9.0, 1.0)) {
    for (const Eigen::Vector3f& p : mesh.vertices) {
      EXPECT_GE(p.z(), -1e-4F);
      EXPECT_LE(p.z(), 2.01F);
      EXPECT_LE(std::abs(p.y()), 4.5F);
    }
  }
  for (const TriangleMesh& mesh : parked(9.0, 0.0))
    for (const Eigen::Vector3f& p : mesh.vertices) EXPECT_GE(std::abs(p.y()), 0.5F + 0.84F);
}

TEST(Visit, ThereAreAsManyAsStatedOnAverage) {
  constexpr int kSeeds = 40;
  std::vector<double> of_one_path;
  for (int seed = 0; seed < kSeeds; ++seed)
    for (const TriangleMesh& mesh : parked(9.0, 1.0, static_cast<std::uint64_t>(seed)))
      of_one_path.push_back(static_cast<double>(num_things(mesh)));
  const double mean = std::accumulate(of_one_path.begin(), of_one_path.end(), 0.0) / (2 * kSeeds);
  EXPECT_NEAR(mean, 20.0, 1.5);  // 12 and 8 in 400 m
  double variance = 0.0;
  for (const double num : of_one_path) variance += (num - mean) * (num - mean) / (2 * kSeeds - 1);
  EXPECT_NEAR(variance, 20.0, 10.0) << "they come one by one";
}

TEST(Visit, TheSameThingsStandThereForAllButThoseThatChange) {
  const auto lasting = parked(9.0, 0.0);
  EXPECT_EQ(lasting[0].vertices, lasting[1].vertices);
  EXPECT_LT(num_things(lasting[0]), 30U) << "both paths are in one hall, which is furnished once";
  const auto half = parked(9.0, 0.5);
  const auto [one, other] = std::ranges::mismatch(half[0].vertices, half[1].vertices);
  const auto num_same = static_cast<std::size_t>(one - half[0].vertices.begin()) / kVerticesOfAThing;
  EXPECT_GE(num_same, 4U);
  EXPECT_GE(num_things(half[0]) - num_same, 4U);
  EXPECT_GE(num_things(half[1]) - num_same, 4U);
}

TEST(Visit, NothingStandsWhereThereIsNoRoom) {
  for (const TriangleMesh& mesh : parked(1.6, 1.0)) EXPECT_EQ(num_things(mesh), 0U);
}

TEST(Visit, PeopleWalkBesideTheRobotAndNotInIt) {
  const Trajectory truth = path(false);
  EXPECT_TRUE(people_around(truth, Stamp{50'000'000'000}, 0).empty());
  const Stamp stamp = truth[500].stamp;
  const Vector3 robot = truth[500].T_world_body.translation();
  const TriangleMesh people = people_around(truth, stamp, 3);
  EXPECT_EQ(people.vertices.size(), 3U * 3U * 8U);
  for (const Eigen::Vector3f& p : people.vertices) {
    const double away = (p.cast<double>() - robot).head<2>().norm();
    EXPECT_GT(away, 0.4);
    EXPECT_LT(away, 10.0);
    EXPECT_LE(p.z(), 1.76F);
  }
}

TEST(Visit, ARobotSeesWhatOnlyItMetAndDust) {
  World world;
  world.name = "hall";
  world.mesh = test::room({-5.0, -4.5, 0.0}, {65.0, 4.5, 5.0});
  world.routes = {{"robot_0", 1.5, {{0, 0, 0}, {60, 0, 0}}}, {"robot_1", 1.5, {{60, 1, 0}, {0, 1, 0}}}};
  ScenarioConfig config;
  config.lidar = lidar_preset("os2-32").value();
  const PointCloud empty = simulate(world, config)->front().read_scan(100)->cloud;
  config.visits.vehicles_per_km = 100.0;
  EXPECT_NE(simulate(world, config)->front().read_scan(100)->cloud.points, empty.points);
  config.visits = {};
  config.visits.dust = 0.05;
  const auto near = [](const PointCloud& cloud) {
    return static_cast<double>(
        std::ranges::count_if(cloud.points, [](const Eigen::Vector3f& p) { return p.norm() < 2.0F; }));
  };
  const PointCloud dusty = simulate(world, config)->front().read_scan(100)->cloud;
  EXPECT_GT(near(dusty) - near(empty), 0.02 * static_cast<double>(empty.size()));
  EXPECT_LT(near(dusty) - near(empty), 0.05 * static_cast<double>(empty.size()));
}

}  // namespace
}  // namespace adit

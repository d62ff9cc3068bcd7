// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/occupancy_grid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/files.hpp"

namespace adit {
namespace {

/// A tunnel along x whose floor rises by `slope` from x = 10 m on; walls at y = +-2 m, 3 m high, from 0 to 30
/// m.
double floor_at(double x, double slope) { return slope * std::max(x - 10.0, 0.0); }

PlacedScan look(double x, double slope, const std::vector<Vector3>& besides = {}) {
  const double pitch = x > 10.0 ? -std::atan(slope) : 0.0;
  PlacedScan scan;
  scan.viewpoint = Vector3(0.0, 0.0, 0.9);
  scan.T_world_base = Pose(Eigen::Quaterniond(Eigen::AngleAxisd(pitch, Vector3::UnitY())),
                           Vector3(x, 0.0, floor_at(x, slope)));
  const Pose T_base_world = scan.T_world_base.inverse();
  PointCloud cloud;
  const auto add = [&](const Vector3& p) { cloud.points.push_back((T_base_world * p).cast<float>()); };
  for (double u = std::max(x - 9.0, 0.0); u < std::min(x + 9.0, 30.0); u += 0.05) {
    for (double y = -1.9; y < 2.0; y += 0.2) add({u, y, floor_at(u, slope)});
    for (double z = 0.1; z < 3.0; z += 0.2)
      for (const double y : {-2.0, 2.0}) add({u, y, floor_at(u, slope) + z});
    add({u, 0.0, floor_at(u, slope) + 3.0});
  }
  for (const Vector3& p : besides) add(p);
  scan.cloud_base = std::make_shared<const PointCloud>(cloud);
  return scan;
}

std::vector<PlacedScan> drive(double slope) {
  std::vector<PlacedScan> scans;
  for (double x = 1.0; x < 29.0; x += 1.0) scans.push_back(look(x, slope));
  return scans;
}

TEST(OccupancyGrid, RampsAreFloorAndWallsAreNot) {
  for (const double slope : {0.0, 0.15}) {
    const Result<OccupancyGrid> grid = occupancy_of(drive(slope), {});
    ASSERT_TRUE(grid) << grid.error().message;
    for (double x = 1.0; x < 29.0; x += 0.5) {
      for (double y = -1.5; y <= 1.5; y += 0.5)
        EXPECT_EQ(grid->at(x, y), CellState::free) << slope << " at " << x << ", " << y;
      for (const double y : {-2.0, 2.01})
        EXPECT_EQ(grid->at(x, y), CellState::occupied) << slope << " at " << x;
      EXPECT_EQ(grid->at(x, 4.0), CellState::unknown) << "behind the wall";
    }
    EXPECT_EQ(grid->at(1000.0, 0.0), CellState::unknown);
  }
}

TEST(OccupancyGrid, WhatHasMovedIsFreeAndWhatStaysIsOccupied) {
  std::vector<PlacedScan> scans = drive(0.0);
  std::vector<Vector3> thing;
  for (double z = 0.3; z < 1.5; z += 0.1) thing.emplace_back(15.0, 1.0, z);
  scans[13] = look(14.0, 0.0, thing);
  EXPECT_EQ(occupancy_of(scans, {})->at(15.0, 1.0), CellState::free) << "seen once, and past by others";
  for (std::size_t i = 0; i < scans.size(); ++i) scans[i] = look(1.0 + static_cast<double>(i), 0.0, thing);
  EXPECT_EQ(occupancy_of(scans, {})->at(15.0, 1.0), CellState::occupied);
}

TEST(OccupancyGrid, OnlyTheBandOfHeightsIsAnObstacle) {
  std::vector<PlacedScan> scans;
  for (int i = 0; i < 3; ++i)
    scans.push_back(look(14.0, 0.0, {{15.0, 1.0, 0.15}, {15.0, -1.0, 2.0}, {16.0, 0.0, 1.0}}));
  const Result<OccupancyGrid> grid = occupancy_of(scans, {});
  EXPECT_EQ(grid->at(15.0, 1.0), CellState::free) << "driven over";
  EXPECT_EQ(grid->at(15.0, -1.0), CellState::free) << "driven under";
  EXPECT_EQ(grid->at(16.0, 0.0), CellState::occupied);
}

TEST(OccupancyGrid, ASensorFarFromTheBaseSeesWithinTheGrid) {
  PlacedScan scan = look(5.0, 0.0);
  PointCloud cloud;
  for (int i = 0; i < 360; ++i)
    cloud.points.emplace_back(Vector3(6.0 + 9.9 * std::cos(i), 9.9 * std::sin(i), 1.0).cast<float>());
  scan.viewpoint = Vector3(6.0, 0.0, 1.0);
  scan.cloud_base = std::make_shared<const PointCloud>(cloud);
  const Result<OccupancyGrid> grid = occupancy_of({scan}, {});
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->at(11.0 + 9.9, 0.0), CellState::occupied);
}

TEST(OccupancyGrid, NoScansAndTooManyCellsAreErrors) {
  EXPECT_ERROR(occupancy_of({}, {}), "no scans");
  EXPECT_ERROR(occupancy_of({look(1.0, 0.0)}, {.lowest_m = 2.0, .highest_m = 1.0}), "grid.lowest_m");
  std::vector<PlacedScan> far = {look(1.0, 0.0), look(2.0, 0.0)};
  far[1].T_world_base = Pose::planar(1e6, 1e6, 0.0);
  EXPECT_ERROR(occupancy_of(far, {}), "resolution of more than 0.1 m");
}

}  // namespace
}  // namespace adit

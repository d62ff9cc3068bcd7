// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/floor_plan.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

double ink(const FloorPlan& plan) { return std::accumulate(plan.density.begin(), plan.density.end(), 0.0); }

TriangleMesh wall_and_floor(double height) {
  TriangleMesh mesh;
  const auto h = static_cast<float>(height);
  mesh.vertices = {{0, 0, 0}, {20, 0, 0}, {20, 0, h}, {0, 0, h}, {20, 10, 0}, {0, 10, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 1, 4}, {0, 4, 5}};
  return mesh;
}

TEST(FloorPlan, AWallLeavesInkAndTheFloorNone) {
  const FloorPlan plan = floor_plan_of(wall_and_floor(1.0), 0.5);
  EXPECT_EQ(plan.width, 41);
  EXPECT_EQ(plan.height, 21);
  // 20 m of wall, 1 m high, over cells of 0.5 m: 40 cells with half of the ink that 2 m would give.
  EXPECT_NEAR(ink(plan), 20.0, 1e-3);
  for (int row = 1; row < plan.height; ++row) {
    for (int column = 0; column < plan.width; ++column) EXPECT_EQ(plan.at(column, row), 0.0F);
  }
  EXPECT_NEAR(plan.at(20, 0), 0.5F, 0.3F);
}

TEST(FloorPlan, InkNeverExceedsOneAndHugeWorldsStayBounded) {
  const FloorPlan tall = floor_plan_of(wall_and_floor(50.0), 0.5);
  for (const float value : tall.density) EXPECT_LE(value, 1.0F);
  TriangleMesh huge = wall_and_floor(1.0);
  for (Eigen::Vector3f& v : huge.vertices) v *= 1e4F;
  EXPECT_LE(floor_plan_of(huge, 0.25).density.size(), 4500000U);
  EXPECT_TRUE(floor_plan_of(TriangleMesh{}, 0.25).empty());
}

TEST(FloorPlan, PointsFallIntoTheirCells) {
  std::vector<Eigen::Vector3f> points = {
      {0.1F, 0.1F, 0.0F}, {3.6F, 0.2F, 9.0F}, {3.7F, 0.2F, 1.0F}, {0.2F, 2.3F, 0.0F}};
  points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 0.0F, 0.0F);
  const FloorPlan plan = floor_plan_of(points, 1.0);
  EXPECT_EQ(plan.width, 4);
  EXPECT_EQ(plan.height, 3);
  EXPECT_GT(plan.at(3, 0), plan.at(0, 0));
  EXPECT_GT(plan.at(0, 2), 0.0F);
  EXPECT_EQ(plan.at(2, 1), 0.0F);
  EXPECT_TRUE(floor_plan_of(std::vector<Eigen::Vector3f>{}, 1.0).empty());
  EXPECT_TRUE(floor_plan_of(std::span(points).last(1), 1.0).empty());
}

}  // namespace
}  // namespace adit

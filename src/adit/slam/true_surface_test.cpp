// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/true_surface.hpp"

#include <gtest/gtest.h>

#include "adit/core/parallel.hpp"
#include "support/files.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

using Points = std::vector<Eigen::Vector3f>;

/// A room of 6 x 4 x 3 m, and its floor as a map: a point every 5 cm, `up` metres too high.
const Vector3 kLow(0, 0, 0);
const Vector3 kHigh(6, 4, 3);

Points floor_map(double up, double from_x = 0.0) {
  Points points;
  for (double x = from_x; x <= 6.0; x += 0.05)
    for (double y = 0.0; y <= 4.0; y += 0.05) points.push_back(Vector3(x, y, up).cast<float>());
  return points;
}

TrueSurface surface_of(const TriangleMesh& mesh) {
  Result<TrueSurface> surface = TrueSurface::build(mesh);
  EXPECT_TRUE(surface) << surface.error().message;
  return *surface;
}

SightConfig every_angle() {
  SightConfig config;
  config.incidence_deg = 90.0;
  return config;
}

TEST(TrueSurface, DistancesAndCompletenessByHand) {
  const TrueSurface surface = surface_of(test::room(kLow, kHigh));
  const Points eyes = {{3, 2, 1}};
  const Result<MapAccuracy> map = surface.compare(floor_map(0.03), eyes, every_angle());
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_NEAR(map->median_m, 0.03, 1e-3);
  EXPECT_NEAR(map->p95_m, 0.03, 1e-3);
  EXPECT_NEAR(map->seen_m2, 108.0, 0.5) << "all sides of the room";
  // The floor, and of the walls the strip that is nearer to the floor's points than 10 cm.
  EXPECT_NEAR(*map->completeness, (24.0 + 20.0 * 0.13) / 108.0, 0.01);

  const Result<MapAccuracy> half = surface.compare(floor_map(0.0, 3.0), eyes, every_angle());
  ASSERT_TRUE(half) << half.error().message;
  EXPECT_NEAR(half->median_m, 0.0, 1e-6);
  EXPECT_LT(*half->completeness, 0.6 * *map->completeness);
}

TEST(TrueSurface, WhatCouldNotBeSeenDoesNotCount) {
  TriangleMesh mesh = test::room(kLow, kHigh);
  append(mesh, test::room({10, 0, 0}, {16, 4, 3}));  // nobody was there
  const TrueSurface surface = surface_of(mesh);
  const Points eyes = {{3, 2, 1}};
  EXPECT_NEAR(surface.compare(floor_map(0.0), eyes, every_angle())->seen_m2, 108.0, 0.5);
  SightConfig near = every_angle();
  near.reach_m = 1.5;  // of the floor a disc, as far as a ray of that length falls on it from 1 m above
  EXPECT_NEAR(surface.compare(floor_map(0.0), eyes, near)->seen_m2, 3.1416 * 1.25, 0.6);
  SightConfig steep;
  steep.incidence_deg = 45.0;
  steep.reach_m = 1.9;  // the disc of 45 degrees on the floor; walls and roof are farther
  EXPECT_NEAR(surface.compare(floor_map(0.0), eyes, steep)->seen_m2, 3.1416, 0.6);
}

TEST(TrueSurface, WithoutEyesThereIsNoCompleteness) {
  const TrueSurface surface = surface_of(test::room(kLow, kHigh));
  const Result<MapAccuracy> map = surface.compare(floor_map(0.05), {}, {});
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_FALSE(map->completeness.has_value());
  EXPECT_NEAR(map->median_m, 0.05, 1e-3);
}

TEST(TrueSurface, SaysWhatIsMissing) {
  const TrueSurface surface = surface_of(test::room(kLow, kHigh));
  EXPECT_ERROR(surface.compare({}, {}, {}), "the map has no point");
  const Points nan = {Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN())};
  EXPECT_ERROR(surface.compare(nan, {}, {}), "the map has no point");
  EXPECT_ERROR(surface.compare(floor_map(0.0), Points{{500, 0, 1}}, {}), "do mesh and truth share a frame?");
  EXPECT_ERROR(TrueSurface::build({}), "no triangle");
}

TEST(TrueSurface, IsTheSameWithAnyNumberOfThreads) {
  const TrueSurface surface = surface_of(test::room(kLow, kHigh));
  const Points eyes = {{3, 2, 1}};
  const int threads_before = num_threads();
  set_num_threads(1);
  const MapAccuracy one = *surface.compare(floor_map(0.04), eyes, {});
  set_num_threads(3);
  const MapAccuracy three = *surface.compare(floor_map(0.04), eyes, {});
  set_num_threads(threads_before);
  EXPECT_EQ(one.median_m, three.median_m);
  EXPECT_EQ(one.p95_m, three.p95_m);
  EXPECT_EQ(one.completeness, three.completeness);
}

TEST(TrueSurface, EyesAreAMetreApartAndOfTheDriveOnly) {
  Trajectory truth;
  for (int k = 0; k <= 100; ++k) truth.push_back({Stamp{k}, Pose::translation_of(0.1 * k, 0, 0)});
  const Points eyes = eyes_of(truth, Stamp{20}, Stamp{60}, Vector3(0, 0, 0.9));
  ASSERT_GE(eyes.size(), 4U);
  EXPECT_FLOAT_EQ(eyes.front().x(), 2.0F);
  EXPECT_FLOAT_EQ(eyes.front().z(), 0.9F);
  EXPECT_LE(eyes.back().x(), 6.0F);
  for (std::size_t i = 1; i < eyes.size(); ++i) EXPECT_NEAR((eyes[i] - eyes[i - 1]).norm(), 1.0, 0.11);
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/beam.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "adit/core/angles.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

constexpr float kFar = 100.0F;

/// Level rays from the origin around the x axis, `step_deg` apart.
RayBlock level_fan(double middle_deg, double step_deg, std::size_t num) {
  RayBlock rays;
  rays.size = num;
  for (std::size_t i = 0; i < num; ++i) {
    const double angle =
        (middle_deg + step_deg * (static_cast<double>(i) - static_cast<double>(num) / 2.0)) * kDegree;
    rays.origins.x[i] = rays.origins.y[i] = rays.origins.z[i] = 0.0F;
    rays.directions.x[i] = static_cast<float>(std::cos(angle));
    rays.directions.y[i] = static_cast<float>(std::sin(angle));
    rays.directions.z[i] = 0.0F;
  }
  return rays;
}

/// A wall at x = 20 and, to the left of the x axis, another one `step` before it.
Raycaster step_in_a_wall(double step) {
  TriangleMesh mesh;
  test::add_quad(mesh, {20, -30, -9}, {20, -30, 9}, {20, 30, 9}, {20, 30, -9});
  const double x = 20.0 - step;
  test::add_quad(mesh, {x, 0, -9}, {x, 0, 9}, {x, 30, 9}, {x, 30, -9});
  return Raycaster::build(mesh).value();
}

/// Ranges as distances from the plane x = 0.
std::vector<double> depths(const Raycaster& world, const Beam& beam, RayBlock rays) {
  cast_rays(world, {}, kFar, rays);
  widen_rays(world, {}, beam, {}, kFar, 7, rays);
  std::vector<double> out;
  for (std::size_t i = 0; i < rays.size; ++i)
    out.push_back(static_cast<double>(rays.distances[i] * rays.directions.x[i]));
  return out;
}

TEST(Beam, WithoutWidthIsARay) {
  const Raycaster world = step_in_a_wall(1.0);
  RayBlock rays = level_fan(0.0, 0.1, 64);
  RayBlock beams = rays;
  world.cast(rays, kFar);
  cast_rays(world, {}, kFar, beams);
  widen_rays(world, {}, {}, {}, kFar, 7, beams);
  for (std::size_t i = 0; i < rays.size; ++i) EXPECT_EQ(beams.distances[i], rays.distances[i]);
}

TEST(Beam, AnEdgeIsOneSurfaceOrTheOtherWhereTheyAreMoreThanAPulseApart) {
  const Beam beam{0.18 * kDegree, 0.3};
  for (const double depth : depths(step_in_a_wall(1.0), beam, level_fan(0.0, 0.02, 100)))
    EXPECT_LT(std::min(std::abs(depth - 19.0), std::abs(depth - 20.0)), 0.01) << depth;
}

TEST(Beam, AnEdgeIsSmearedWhereSurfacesAreLessThanAPulseApart) {
  const Raycaster world = step_in_a_wall(0.2);
  const auto num_between = [&](double divergence_deg) {
    const auto found = depths(world, {divergence_deg * kDegree, 0.3}, level_fan(0.0, 0.02, 100));
    return std::ranges::count_if(found, [](double depth) { return depth > 19.82 && depth < 19.98; });
  };
  EXPECT_EQ(num_between(0.0), 0);
  EXPECT_GT(num_between(0.18), 0);
}

// One ray per block, as in a column that runs along the edge: only the columns beside it show the edge.
TEST(Beam, AnEdgeIsFoundByTheColumnsBesideIt) {
  const Raycaster world = step_in_a_wall(0.2);
  const Beam beam{0.18 * kDegree, 0.3};
  RayBlock rays = level_fan(0.0, 0.0, 1);
  cast_rays(world, {}, kFar, rays);
  const RayBlock::Numbers left{19.8F};
  const RayBlock::Numbers right{20.0F};
  RayBlock alone = rays;
  widen_rays(world, {}, beam, {}, kFar, 7, alone);
  EXPECT_EQ(alone.distances[0], rays.distances[0]);
  int num_between = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    RayBlock beams = rays;
    widen_rays(world, {}, beam, {&left, &right}, kFar, seed, beams);
    num_between += beams.distances[0] > 19.82F && beams.distances[0] < 19.98F;
  }
  EXPECT_GT(num_between, 25);
}

// As long as the footprint, and right on average, whether or not it is longer than a pulse.
TEST(Beam, ReturnsOfAGrazedWallLieEvenlyWithinItsFootprint) {
  constexpr double kDivergence = 0.18 * kDegree;
  for (const double grazing_deg : {15.0, 10.0, 5.0}) {
    TriangleMesh mesh;  // 30 m away
    const double away = 30.0 * std::sin(grazing_deg * kDegree);
    test::add_quad(mesh, {-90, away, -9}, {90, away, -9}, {90, away, 9}, {-90, away, 9});
    const Raycaster world = Raycaster::build(mesh).value();
    RayBlock beams = level_fan(grazing_deg, 1e-4, 100);
    cast_rays(world, {}, kFar, beams);
    widen_rays(world, {}, {kDivergence, 0.3}, {}, kFar, 7, beams);
    const double half_footprint = 0.5 * 30.0 * kDivergence / std::tan(grazing_deg * kDegree);
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t i = 0; i < beams.size; ++i) {
      const double off = static_cast<double>(beams.distances[i]) - 30.0;
      EXPECT_LT(std::abs(off), half_footprint + 0.02);
      sum += off / static_cast<double>(beams.size);
      squares += off * off / static_cast<double>(beams.size);
    }
    EXPECT_LT(std::abs(sum), 0.15 * half_footprint) << grazing_deg;
    EXPECT_GT(std::sqrt(squares), 0.25 * half_footprint) << grazing_deg;
  }
}

TEST(Beam, MeetsWhatMovesBeforeTheWorld) {
  TriangleMesh person;
  test::add_quad(person, {5, -0.3, -1}, {5, -0.3, 1}, {5, 0.3, 1}, {5, 0.3, -1});
  RayBlock rays = level_fan(0.0, 0.5, 41);
  EXPECT_TRUE(cast_rays(step_in_a_wall(1.0), Raycaster::build(person).value(), kFar, rays));
  EXPECT_FLOAT_EQ(rays.distances[20], 5.0F / rays.directions.x[20]);
  EXPECT_GT(rays.distances[0], 18.0F);
}

}  // namespace
}  // namespace adit

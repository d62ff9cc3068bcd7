// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/point_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "adit/core/records.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

using Points = std::vector<Eigen::Vector3f>;

/// Rounded coordinates, so that many points coincide and many distances are equal.
Points lattice_points(std::uint64_t seed, std::size_t n) {
  Rng rng(seed);
  Points points;
  for (std::size_t i = 0; i < n; ++i) {
    points.emplace_back(static_cast<float>(rng.below(12)), static_cast<float>(rng.below(12)),
                        static_cast<float>(rng.below(4)));
  }
  return points;
}

Points scattered_points(std::uint64_t seed, std::size_t n) {
  Rng rng(seed);
  Points points;
  for (std::size_t i = 0; i < n; ++i) {
    points.emplace_back(static_cast<float>(100.0 * rng.normal()), static_cast<float>(rng.normal()),
                        static_cast<float>(rng.uniform(-1.0, 1.0)));
  }
  return points;
}

std::vector<Neighbor> sorted_by_brute_force(const Points& points, const Eigen::Vector3f& query) {
  std::vector<Neighbor> all;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f d = points[i] - query;
    if (points[i].allFinite()) all.push_back({i, d.x() * d.x() + d.y() * d.y() + d.z() * d.z()});
  }
  std::sort(all.begin(), all.end(), [](const Neighbor& a, const Neighbor& b) {
    return std::tie(a.squared_distance, a.index) < std::tie(b.squared_distance, b.index);
  });
  return all;
}

void expect_same_as_brute_force(const Points& points, const Points& queries, double cell_size = 2.0) {
  const PointGrid grid(points, cell_size);
  for (const Eigen::Vector3f& query : queries) {
    const std::vector<Neighbor> expected = sorted_by_brute_force(points, query);
    const auto nearest = grid.nearest(query);
    ASSERT_EQ(nearest.has_value(), !expected.empty());
    if (nearest) {
      EXPECT_EQ(*nearest, expected.front());
    }
    const auto alone = grid.nearest_alone(query, 25.0F);
    const bool is_near = !expected.empty() && expected[0].squared_distance <= 25.0F;
    ASSERT_EQ(alone.has_value(), is_near);
    if (alone) {
      const float others = expected.size() > 1 ? std::min(expected[1].squared_distance, 25.0F) : 25.0F;
      EXPECT_EQ(*alone, (NearestAlone{expected[0].index, expected[0].squared_distance, others}));
    }
  }
}

TEST(PointGrid, AgreesWithBruteForceOnTies) {
  expect_same_as_brute_force(lattice_points(1, 700), lattice_points(2, 100));
}

TEST(PointGrid, AgreesWithBruteForceOnStretchedClouds) {
  expect_same_as_brute_force(scattered_points(3, 900), scattered_points(4, 100));
}

TEST(PointGrid, HandlesDegenerateClouds) {
  expect_same_as_brute_force({}, lattice_points(5, 3));
  expect_same_as_brute_force({{1.0F, 2.0F, 3.0F}}, lattice_points(6, 3));
  expect_same_as_brute_force(Points(200, {1.0F, 1.0F, 1.0F}), lattice_points(7, 20));
  Points line;
  for (int i = 0; i < 100; ++i) line.emplace_back(0.0F, static_cast<float>(i), 0.0F);
  expect_same_as_brute_force(line, lattice_points(8, 20));
}

TEST(PointGrid, NeverFindsPointsThatAreNotFinite) {
  Points points = lattice_points(9, 100);
  points[3].x() = std::nanf("");
  points[50].z() = std::numeric_limits<float>::infinity();
  expect_same_as_brute_force(points, lattice_points(10, 20));
  const PointGrid grid(points, 1.0);
  EXPECT_EQ(grid.size(), 98U);
  EXPECT_FALSE(grid.nearest({std::nanf(""), 0.0F, 0.0F}).has_value());
  EXPECT_FALSE(grid.nearest_alone({std::nanf(""), 0.0F, 0.0F}, 10.0F).has_value());
}

TEST(PointGrid, AnswersDoNotDependOnTheCells) {
  const Points points = scattered_points(11, 400);
  for (const double cell_size : {1e-9, 0.3, 7.0, 1e6})
    expect_same_as_brute_force(points, scattered_points(12, 50), cell_size);
  expect_same_as_brute_force(points, {{1e6F, -1e6F, 0.0F}, {0.0F, 0.0F, 500.0F}}, 0.3);
  Points far = lattice_points(13, 300);  // where floats are coarse
  Points near_them = lattice_points(14, 50);
  for (Points* shifted : {&far, &near_them})
    for (Eigen::Vector3f& p : *shifted) p = 0.37F * p + Eigen::Vector3f(50000.0F, -70000.0F, 900.0F);
  for (const double cell_size : {0.01, 0.37, 3.0}) expect_same_as_brute_force(far, near_them, cell_size);
}

std::size_t num_nearer_by_brute_force(const Points& points, const Eigen::Vector3f& query, float bound) {
  return static_cast<std::size_t>(std::ranges::count_if(
      points, [&](const Eigen::Vector3f& point) { return (point - query).squaredNorm() < bound; }));
}

TEST(PointGrid, CountsAsManyNearerAsBruteForce) {
  Points with_holes = lattice_points(17, 300);
  with_holes[3].x() = std::nanf("");
  with_holes[50].z() = std::numeric_limits<float>::infinity();
  for (const Points& points : {Points(), lattice_points(15, 700), scattered_points(16, 900), with_holes})
    for (const double cell_size : {0.3, 2.0, 50.0}) {
      const PointGrid grid(points, cell_size);
      // Distances of a lattice are equal to some of these bounds: they do not count.
      for (const float bound : {0.0F, 1.0F, 2.0F, 5.0F, 9.5F, 1e4F, std::numeric_limits<float>::infinity()})
        for (const Points& queries : {lattice_points(18, 20), scattered_points(19, 20), with_holes})
          for (const Eigen::Vector3f& query : queries)
            ASSERT_EQ(grid.num_nearer(query, bound), num_nearer_by_brute_force(points, query, bound));
    }
}

TEST(PointGrid, CountsNearerWithTheRoundingOfEigen) {
  // On a sphere the last bit decides which point is nearer than its radius.
  constexpr float kRadius = 0.45F;
  Rng rng(20);
  const Eigen::Vector3f middle(3.1F, -2.7F, 0.9F);
  Points sphere;
  for (int i = 0; i < 5000; ++i) {
    const Vector3 direction = Vector3(rng.normal(), rng.normal(), rng.normal()).normalized();
    sphere.emplace_back(middle + kRadius * direction.cast<float>());
  }
  const std::size_t expected = num_nearer_by_brute_force(sphere, middle, kRadius * kRadius);
  EXPECT_GT(expected, 100U);
  EXPECT_LT(expected, 4900U);
  EXPECT_EQ(PointGrid(sphere, 0.9).num_nearer(middle, kRadius * kRadius), expected);
}

TEST(PointGrid, TakesFewBytesHoweverFarPointsAre) {
  const PointGrid grid(Points{{-1e9F, 0.0F, 0.0F}, {1e9F, 3.0F, 1e9F}, {0.0F, 0.0F, 0.0F}}, 0.1);
  EXPECT_EQ(grid.nearest({1.0F, 0.0F, 0.0F})->index, 2U);
  EXPECT_LT(grid.num_bytes(), 1000U);
}

TEST(PointGrid, NearestKeepsToTheLargestDistance) {
  const PointGrid grid(Points{{0.0F, 0.0F, 0.0F}, {5.0F, 0.0F, 0.0F}}, 1.0);
  EXPECT_FALSE(grid.nearest({2.0F, 0.0F, 0.0F}, 1.9F).has_value());
  EXPECT_EQ(grid.nearest({2.0F, 0.0F, 0.0F}, 2.0F)->index, 0U);  // inclusive
}

}  // namespace
}  // namespace adit

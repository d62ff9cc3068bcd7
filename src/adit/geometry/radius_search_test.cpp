// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/radius_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

using Points = std::vector<Eigen::Vector3f>;
using Pair = std::pair<std::uint32_t, std::uint32_t>;

Points random_points(std::uint64_t seed, std::size_t n, double extent) {
  Rng rng(seed);
  Points points;
  for (std::size_t i = 0; i < n; ++i) {
    points.emplace_back(
        Eigen::Vector3d(rng.uniform(-extent, extent), rng.uniform(-extent, extent), rng.uniform(-1.0, 1.0))
            .cast<float>());
  }
  return points;
}

std::set<Pair> pairs_by_brute_force(const Points& points, float radius) {
  std::set<Pair> out;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    for (std::uint32_t j = i + 1; j < points.size(); ++j) {
      if ((points[i] - points[j]).squaredNorm() <= radius * radius) out.emplace(i, j);
    }
  }
  return out;
}

/// Fails when a pair is listed twice, with itself, or with a wrong distance.
std::set<Pair> unordered_pairs(const Points& points, const NeighborPairs& pairs) {
  std::set<Pair> out;
  for (std::uint32_t i = 0; i < pairs.num_points(); ++i) {
    for (const Neighbor& neighbor : pairs.row(i)) {
      EXPECT_NE(i, neighbor.index);
      EXPECT_FLOAT_EQ(neighbor.squared_distance, (points[i] - points[neighbor.index]).squaredNorm());
      EXPECT_TRUE(out.insert(std::minmax(i, neighbor.index)).second);
    }
  }
  return out;
}

TEST(RadiusSearch, FindsEveryPairOnce) {
  for (const float radius : {0.3F, 1.0F, 4.0F}) {
    const Points points = random_points(1, 400, 6.0);
    EXPECT_EQ(unordered_pairs(points, find_pairs_within(points, radius)),
              pairs_by_brute_force(points, radius));
  }
}

TEST(RadiusSearch, FindsPairsAcrossCellBorders) {
  Points lattice;  // every neighbour at exactly the radius, on the borders of cells
  for (int x = -3; x <= 3; ++x) {
    for (int y = -3; y <= 3; ++y)
      lattice.emplace_back(0.3F * static_cast<float>(x), 0.3F * static_cast<float>(y), 0.0F);
  }
  EXPECT_EQ(unordered_pairs(lattice, find_pairs_within(lattice, 0.3F)), pairs_by_brute_force(lattice, 0.3F));
}

TEST(RadiusSearch, HandlesDegenerateClouds) {
  EXPECT_EQ(find_pairs_within({}, 1.0F).num_points(), 0U);
  EXPECT_EQ(find_pairs_within({{1.0F, 2.0F, 3.0F}}, 1.0F).num_points(), 1U);
  const Points copies(20, {5.0F, 5.0F, 5.0F});
  EXPECT_EQ(find_pairs_within(copies, 1.0F).neighbors.size(), 190U);
  EXPECT_THROW((void)find_pairs_within(copies, 0.0F), ContractViolation);
}

TEST(RadiusSearch, LeavesOutPointsThatAreNotFiniteOrAbsurdlyFar) {
  Points points = random_points(2, 50, 2.0);
  points[7].y() = std::nanf("");
  points[8].y() = 1e30F;
  points[9].y() = -std::numeric_limits<float>::infinity();
  const std::set<Pair> found = unordered_pairs(points, find_pairs_within(points, 1.0F));
  EXPECT_EQ(found, pairs_by_brute_force(points, 1.0F));  // comparisons with NaN are false there too
  for (const auto& [i, j] : found) EXPECT_FALSE(i >= 7 && i <= 9);
}

}  // namespace
}  // namespace adit

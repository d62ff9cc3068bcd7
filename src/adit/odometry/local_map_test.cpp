// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/local_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

std::vector<Eigen::Vector3f> random_points(std::size_t n, double half_width, std::uint64_t seed) {
  Rng rng(seed);
  const auto draw = [&] { return static_cast<float>(rng.uniform(-half_width, half_width)); };
  std::vector<Eigen::Vector3f> points(n);
  for (Eigen::Vector3f& p : points) p = {draw(), draw(), draw()};
  return points;
}

// The definition, point by point: nearest of the 27 voxels around the query, strictly within reach.
std::optional<float> brute_force(const std::vector<Eigen::Vector3f>& points, const VoxelGrid& grid,
                                 const Eigen::Vector3f& query, float reach) {
  std::optional<float> best;
  const Eigen::Vector3i home = grid.key_of(query)->indices();
  for (const Eigen::Vector3f& p : points) {
    const float d2 = (p - query).squaredNorm();
    if ((grid.key_of(p)->indices() - home).cwiseAbs().maxCoeff() > 1 || d2 >= reach * reach) continue;
    if (!best || d2 < *best) best = d2;
  }
  return best;
}

TEST(LocalMap, NearestIsTheBruteForceNearest) {
  LocalMap map(0.8, 20);
  map.add(random_points(3000, 4.0, 1), Pose());
  const std::vector<Eigen::Vector3f> points = map.points();
  const VoxelGrid grid(0.8);
  int found = 0;
  for (const float reach : {0.05F, 0.3F, 0.9F, 5.0F}) {
    for (const Eigen::Vector3f& query : random_points(400, 5.0, 2)) {
      const auto fast = map.nearest(query, reach);
      const auto slow = brute_force(points, grid, query, reach);
      ASSERT_EQ(fast.has_value(), slow.has_value());
      if (!fast) continue;
      EXPECT_FLOAT_EQ(fast->squared_distance, *slow);
      EXPECT_FLOAT_EQ((fast->point - query).squaredNorm(), *slow);
      ++found;
    }
  }
  EXPECT_GT(found, 500);
}

TEST(LocalMap, KeepsCapacityAndSpacing) {
  LocalMap map(1.0, 7);  // not a multiple of four
  map.add(random_points(20000, 2.0, 3), Pose());
  const VoxelGrid grid(1.0);
  std::map<VoxelKey, std::vector<Eigen::Vector3f>> voxels;
  for (const Eigen::Vector3f& p : map.points()) voxels[*grid.key_of(p)].push_back(p);
  EXPECT_EQ(voxels.size(), map.num_voxels());
  for (const auto& [key, points] : voxels) {
    EXPECT_LE(points.size(), 7U);
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) EXPECT_GE((points[i] - points[j]).norm(), 0.99F / std::sqrt(7.0F));
  }
}

TEST(LocalMap, AddsInTheMapFrame) {
  const Pose T_map_base = Pose::planar(3.0, -2.0, 1.1, 0.4);
  const std::vector<Eigen::Vector3f> points = {{1.0F, 2.0F, 3.0F}};
  LocalMap map(1.0, 20);
  map.add(points, T_map_base);
  EXPECT_LT((map.points().at(0).cast<double>() - T_map_base * Vector3(1.0, 2.0, 3.0)).norm(), 1e-6);
}

TEST(LocalMap, ForgetsWhatIsFarAndUsesTheRoomAgain) {
  LocalMap map(1.0, 20);
  const std::vector<Eigen::Vector3f> cloud = random_points(4000, 6.0, 4);
  map.add(cloud, Pose());
  const std::size_t before = map.num_points();
  map.remove_beyond({0, 0, 0}, 4.0);
  EXPECT_LT(map.num_points(), before);
  for (const Eigen::Vector3f& p : map.points()) EXPECT_LT(p.norm(), 4.0F + std::sqrt(3.0F));
  EXPECT_FALSE(map.nearest({5.5F, 5.5F, 5.5F}, 1.0F));
  map.add(cloud, Pose());
  const VoxelGrid grid(1.0);
  const std::vector<Eigen::Vector3f> points = map.points();
  for (const Eigen::Vector3f& query : random_points(300, 6.0, 5)) {
    const auto fast = map.nearest(query, 1.0F);
    const auto slow = brute_force(points, grid, query, 1.0F);
    ASSERT_EQ(fast.has_value(), slow.has_value());
    EXPECT_FLOAT_EQ(fast ? fast->squared_distance : 0.0F, slow.value_or(0.0F));
  }
  map.remove_beyond({1000, 0, 0}, 4.0);
  EXPECT_TRUE(map.empty());
  EXPECT_EQ(map.num_points(), 0U);
}

TEST(LocalMap, ClearanceIsTrueAndSaysSomething) {
  LocalMap map(0.8, 20);
  map.add(random_points(3000, 4.0, 1), Pose());
  const std::vector<Eigen::Vector3f> points = map.points();
  const VoxelGrid grid(0.8);
  double clearance = 0.0;
  double distance = 0.0;
  for (const float margin : {0.0F, 0.1F}) {
    for (const float reach : {0.05F, 0.3F, 0.9F, 5.0F}) {
      for (const Eigen::Vector3f& query : random_points(200, 5.0, 2)) {
        const LocalMap::Candidates found = map.search(query, reach, margin);
        const Eigen::Vector3i home = grid.key_of(query)->indices();
        for (const Eigen::Vector3f& p : points) {
          // With bounded room the query stays in its voxel, and only the neighbourhood of that counts.
          if (found.room < 0.5F && (grid.key_of(p)->indices() - home).cwiseAbs().maxCoeff() > 1) continue;
          if (std::ranges::find(found.points, p) != found.points.end()) continue;
          EXPECT_LE(found.clearance, (p - query).norm() * 1.00001F);
        }
        const auto nearest = map.nearest(query, reach);
        if (!nearest || reach > 0.8F) continue;
        clearance += static_cast<double>(found.clearance);
        distance += std::sqrt(static_cast<double>(nearest->squared_distance));
      }
    }
  }
  EXPECT_GT(clearance, 1.3 * distance);
}

TEST(LocalMap, MomentsWithinRadius) {
  LocalMap map(1.0, 20);
  map.add(random_points(5000, 3.0, 6), Pose());
  for (const Eigen::Vector3f& centre : random_points(50, 3.0, 7)) {
    LocalMap::Moments expected;
    for (const Eigen::Vector3f& p : map.points()) {
      const Eigen::Vector3f d = p - centre;
      if (!(d.squaredNorm() < 0.64F)) continue;
      ++expected.count;
      expected.sum += d;
      expected.squares += d * d.transpose();
    }
    const LocalMap::Moments moments = map.moments_within(centre, 0.8F);
    EXPECT_EQ(moments.count, expected.count);
    EXPECT_LT((moments.sum - expected.sum).norm(), 1e-4F);
    EXPECT_LT((moments.squares - expected.squares).norm(), 1e-4F);
  }
}

TEST(LocalMap, AwkwardPoints) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  LocalMap map(1.0, 20);
  EXPECT_FALSE(map.nearest({0, 0, 0}, 1.0F));
  const std::vector<Eigen::Vector3f> points = {
      {nan, 0, 0}, {0.5F, 0.5F, 0.5F}, {0.5F, 0.5F, 0.5F}, {1e30F, 0, 0}};
  map.add(points, Pose());
  EXPECT_EQ(map.num_points(), 1U);
  EXPECT_FALSE(map.nearest({nan, 0, 0}, 1.0F));
  EXPECT_EQ(map.nearest({0.5F, 0.5F, 0.5F}, 1.0F)->squared_distance, 0.0F);
  EXPECT_FALSE(map.nearest({0.5F, 0.5F, 0.5F}, 0.0F));
  EXPECT_THROW(LocalMap(1.0, 0), ContractViolation);
}

}  // namespace
}  // namespace adit

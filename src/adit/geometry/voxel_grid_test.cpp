// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/voxel_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

PointCloud random_cloud(std::size_t n, double half_width) {
  Rng rng(3);
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    cloud.points.emplace_back(Vector3(rng.uniform(-half_width, half_width),
                                      rng.uniform(-half_width, half_width),
                                      rng.uniform(-half_width, half_width))
                                  .cast<float>());
    cloud.intensities.push_back(static_cast<float>(i));
    cloud.time_offsets_ns.push_back(-static_cast<std::int32_t>(i));
  }
  return cloud;
}

std::array<int, 3> cell_of(const Eigen::Vector3f& p, float size) {
  const Eigen::Vector3f inverse = p * (1.0F / size);
  return {static_cast<int>(std::floor(inverse.x())), static_cast<int>(std::floor(inverse.y())),
          static_cast<int>(std::floor(inverse.z()))};
}

TEST(VoxelKey, IndicesAndNeighbours) {
  for (const Eigen::Vector3i& v :
       {Eigen::Vector3i(0, 0, 0), Eigen::Vector3i(-1, 5, -7), Eigen::Vector3i(-900000, 1, 900000)}) {
    const VoxelKey key = VoxelKey::of(v.x(), v.y(), v.z());
    EXPECT_EQ(key.indices(), v);
    for (int i = 0; i < 27; ++i) {
      const Eigen::Vector3i d(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      EXPECT_EQ(key.shifted(d.x(), d.y(), d.z()).indices(), v + d);
    }
  }
}

TEST(VoxelGrid, FloorsAndRefusesWhatHasNoVoxel) {
  const VoxelGrid grid(0.5);
  EXPECT_EQ(grid.key_of({-0.01F, 0.0F, 0.49F})->indices(), Eigen::Vector3i(-1, 0, 0));
  EXPECT_FALSE(grid.key_of({kNan, 0.0F, 0.0F}));
  EXPECT_FALSE(grid.key_of({0.0F, std::numeric_limits<float>::infinity(), 0.0F}));
  EXPECT_FALSE(grid.key_of({0.0F, 0.0F, 1e30F}));
  EXPECT_THROW(VoxelGrid(0.0), ContractViolation);
  EXPECT_THROW(VoxelGrid(-1.0), ContractViolation);
}

TEST(VoxelGrid, KeysOfManyAreThoseOfEach) {
  const VoxelGrid grid(0.3);
  std::vector<Eigen::Vector3f> points = random_cloud(1003, 50.0).points;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const float odd : {kNan, kInfinity, -kInfinity, 1e30F, -1e30F, 314572.0F, 314573.0F, -314572.5F,
                          -314573.0F, 0.0F, -0.0F, 0.3F, -0.3F, -1e-30F}) {
    points.emplace_back(odd, 1.0F, -2.0F);
    points.emplace_back(1.0F, odd, -2.0F);
    points.emplace_back(1.0F, -2.0F, odd);
  }
  std::vector<VoxelKey> keys(points.size());
  grid.keys_of(points, keys);
  for (std::size_t i = 0; i < points.size(); ++i)
    EXPECT_EQ(keys[i], grid.key_of(points[i]).value_or(VoxelKey::none())) << points[i].transpose();
}

TEST(VoxelTable, BehavesLikeAMapUnderInsertionAndErasure) {
  VoxelTable table;
  std::map<VoxelKey, std::uint32_t> oracle;
  Rng rng(11);
  for (std::uint32_t i = 0; i < 20000; ++i) {
    const auto draw = [&] { return static_cast<int>(rng.below(12)) - 6; };
    const VoxelKey key = VoxelKey::of(draw(), draw(), draw());
    if (rng.below(2) == 0) {
      EXPECT_EQ(table.erase(key), oracle.erase(key) == 1);
    } else {
      const auto [where, inserted] = oracle.try_emplace(key, i);
      EXPECT_EQ(table.find_or_insert(key, i), inserted ? std::nullopt : std::optional(where->second));
    }
    ASSERT_EQ(table.size(), oracle.size());
  }
  for (int i = 0; i < 12 * 12 * 12; ++i) {
    const VoxelKey key = VoxelKey::of(i % 12 - 6, i / 12 % 12 - 6, i / 144 - 6);
    const auto where = oracle.find(key);
    EXPECT_EQ(table.find(key), where == oracle.end() ? std::nullopt : std::optional(where->second));
  }
}

TEST(VoxelDownsample, KeepsTheFirstPointOfEachVoxelInOrder) {
  PointCloud cloud = random_cloud(30000, 4.0);
  cloud.points[17] = {kNan, 0.0F, 0.0F};
  std::map<std::array<int, 3>, std::size_t> first;
  std::vector<std::size_t> expected;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud.points[i].allFinite() && first.try_emplace(cell_of(cloud.points[i], 0.4F), i).second)
      expected.push_back(i);
  const PointCloud thin = voxel_downsample(cloud, 0.4);
  ASSERT_EQ(thin.size(), expected.size());
  for (std::size_t k = 0; k < expected.size(); ++k) {
    EXPECT_EQ(thin.points[k], cloud.points[expected[k]]);
    EXPECT_EQ(thin.intensities[k], cloud.intensities[expected[k]]);
    EXPECT_EQ(thin.time_offsets_ns[k], cloud.time_offsets_ns[expected[k]]);
  }
  EXPECT_EQ(voxel_downsample(std::span<const Eigen::Vector3f>(cloud.points), 0.4), thin.points);
  EXPECT_EQ(voxel_downsample(thin, 0.4).points, thin.points);
}

TEST(VoxelThinner, RemembersNothingOfTheCloudBefore) {
  const PointCloud one = random_cloud(40000, 4.0);
  const PointCloud other = random_cloud(2000, 4.0);
  VoxelThinner thinner;
  for (const PointCloud& cloud : {one, other, one}) {
    const auto kept = thinner.first_in_voxel(cloud.points, 0.3);
    VoxelThinner fresh;
    EXPECT_TRUE(std::ranges::equal(kept, fresh.first_in_voxel(cloud.points, 0.3)));
  }
}

TEST(VoxelCentroids, AreTheMeans) {
  const PointCloud cloud = random_cloud(5000, 2.0);
  const PointCloud thin = voxel_centroids(cloud, 0.7);
  std::map<std::array<int, 3>, std::pair<Vector3, double>> sums;
  for (const Eigen::Vector3f& p : cloud.points) {
    auto& [sum, count] = sums.try_emplace(cell_of(p, 0.7F), Vector3::Zero(), 0.0).first->second;
    sum += p.cast<double>();
    count += 1.0;
  }
  ASSERT_EQ(thin.size(), sums.size());
  for (const Eigen::Vector3f& p : thin.points) {
    const auto& [sum, count] = sums.at(cell_of(p, 0.7F));
    EXPECT_LT((sum / count - p.cast<double>()).norm(), 1e-6);
  }
}

TEST(VoxelCentroids, CarryIntensityAndTime) {
  const PointCloud cloud{{{0.1F, 0, 0}, {5, 5, 5}, {0.3F, 0, 0}}, {1.0F, 9.0F, 2.0F}, {-10, -9, -5}};
  const PointCloud thin = voxel_centroids(cloud, 1.0);
  ASSERT_EQ(thin.size(), 2U);
  EXPECT_FLOAT_EQ(thin.points[0].x(), 0.2F);
  EXPECT_EQ(thin.intensities, (std::vector<float>{1.5F, 9.0F}));
  EXPECT_EQ(thin.time_offsets_ns, (std::vector<std::int32_t>{-8, -9}));
}

TEST(VoxelFilters, EmptyAndAllNanGiveEmpty) {
  EXPECT_TRUE(voxel_downsample(PointCloud{}, 1.0).empty());
  EXPECT_TRUE(voxel_centroids(PointCloud{}, 1.0).empty());
  EXPECT_TRUE(voxel_downsample(PointCloud{{{kNan, 0, 0}}, {}, {}}, 1.0).empty());
  EXPECT_TRUE(voxel_centroids(PointCloud{{{kNan, 0, 0}}, {}, {}}, 1.0).empty());
  EXPECT_THROW(static_cast<void>(voxel_downsample(PointCloud{{{0, 0, 0}}, {1.0F, 2.0F}, {}}, 1.0)),
               ContractViolation);
}

}  // namespace
}  // namespace adit

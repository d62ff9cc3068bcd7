// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/robot_map_file.hpp"

#include <gtest/gtest.h>

#include "adit/core/rng.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

Pose random_pose(Rng& rng) {
  Vector6 xi;
  for (int i = 0; i < 6; ++i) xi[i] = rng.uniform(-2.0, 2.0);
  return Pose::exp(xi);
}

PointCloud random_cloud(Rng& rng, std::size_t size) {
  PointCloud cloud;
  for (std::size_t i = 0; i < size; ++i) {
    cloud.points.emplace_back(Vector3(rng.normal(), rng.normal(), rng.normal()).cast<float>());
    cloud.intensities.push_back(static_cast<float>(rng.uniform()));
  }
  return cloud;
}

RobotMap random_map() {
  Rng rng(5);
  RobotMap map;
  map.id = {3};
  map.name = "robot_3";
  map.scan_context.max_radius_m = 30.0;
  map.num_degenerate = 4;
  map.num_refused = 1;
  for (std::uint32_t k = 0; k < 5; ++k) {
    const Stamp stamp{1'600'000'000'000'000'001 + static_cast<std::int64_t>(k)};
    const PointCloud cloud = random_cloud(rng, 20 * k);  // The first one is empty.
    map.odometry.push_back({stamp, random_pose(rng)});
    map.keyframes.push_back(
        {{map.id, k}, stamp, random_pose(rng), std::make_shared<const PointCloud>(cloud)});
    map.step_covariances.push_back(Matrix6::Identity() * rng.uniform());
    map.pose_noise.push_back(Matrix6::Identity() * rng.uniform());
    map.places.push_back(describe(cloud, {}));
    map.tunnel.push_back({Vector3(3.0, 2.0, rng.uniform()), k % 2 == 0});
    map.searchable.push_back(k % 3 == 0);
    map.unconfirmed.push_back(0.01F * static_cast<float>(k));
  }
  return map;
}

TEST(RobotMapFile, ReadsBackBitForBit) {
  const RobotMap map = random_map();
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_robot_map(folder / "a.map", map));
  const Result<RobotMap> again = read_robot_map(folder / "a.map");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(robot_map_bytes(*again), robot_map_bytes(map));
  EXPECT_EQ(again->name, map.name);
  EXPECT_EQ(again->scan_context.max_radius_m, 30.0);
  ASSERT_EQ(again->keyframes.size(), 5U);
  EXPECT_EQ(again->keyframes[4].id, map.keyframes[4].id);
  EXPECT_EQ(again->keyframes[4].stamp, map.keyframes[4].stamp);
  EXPECT_TRUE(again->keyframes[4].cloud->points == map.keyframes[4].cloud->points);
  EXPECT_TRUE(again->places[3].unit_columns == map.places[3].unit_columns);
  EXPECT_TRUE(again->keyframes[2].T_odom_base.matrix() == map.keyframes[2].T_odom_base.matrix());
  EXPECT_EQ(again->searchable, map.searchable);
  EXPECT_EQ(again->tunnel[1].tunnel_like, map.tunnel[1].tunnel_like);
}

TEST(RobotMapFile, DamageAndOtherVersionsAreRefused) {
  const std::string bytes = robot_map_bytes(random_map());
  for (std::size_t size = 0; size < bytes.size(); size += 7)
    EXPECT_FALSE(parse_robot_map(std::string_view(bytes).substr(0, size))) << size;
  for (std::size_t at = 0; at < bytes.size(); at += 11) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x40);
    const Result<RobotMap> parsed = parse_robot_map(damaged);
    // Bits of the packing may mean nothing.
    EXPECT_TRUE(!parsed || robot_map_bytes(*parsed) == bytes) << at;
  }
  std::string other = bytes;
  other[9] = '0';
  EXPECT_ERROR(parse_robot_map(other), "before layout 7");
  EXPECT_ERROR(read_robot_map("/nonexistent.map"), "nonexistent");
}

}  // namespace
}  // namespace adit

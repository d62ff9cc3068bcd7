// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/sync/own_map_parts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <tuple>

#include "support/tube_drive.hpp"

namespace adit {
namespace {

using Voxels = std::set<std::tuple<int, int, int>>;

const SentClouds kSent{.voxel_m = 0.3, .submap = {}, .view = {.reach_m = 3.0, .step_m = 1.0}};

Voxels voxels_of(const std::vector<Eigen::Vector3f>& points) {
  Voxels voxels;
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3f cell = (p / static_cast<float>(kSent.voxel_m)).array().floor();
    voxels.insert(
        std::tuple(static_cast<int>(cell.x()), static_cast<int>(cell.y()), static_cast<int>(cell.z())));
  }
  return voxels;
}

TEST(OwnMapParts, AViewIsTheScanAndWhatThoseBesideItSawAlone) {
  const auto map = test::in_a_tube({});
  const Clouds clouds = clouds_of(*map, {{60, 9999}, CloudKind::view}, kSent);
  ASSERT_EQ(clouds.clouds.size(), 1U) << "there is no keyframe 9999";
  const Clouds::Cloud& view = clouds.clouds.front();
  const Voxels own = voxels_of(view.points);
  const Voxels beside = voxels_of(view.beside);
  EXPECT_EQ(own, voxels_of(map->keyframes[60].cloud->points));
  EXPECT_GT(beside.size(), own.size() / 2);
  for (const auto& voxel : beside) EXPECT_FALSE(own.contains(voxel));
  for (const auto& voxel : voxels_of(submap(*map, 60, kSent.view).points))
    EXPECT_TRUE(own.contains(voxel) || beside.contains(voxel));
}

TEST(OwnMapParts, AViewHasTheIntensitiesOfTheScan) {
  RobotMap map = *test::in_a_tube({});
  PointCloud scan = *map.keyframes[60].cloud;
  scan.intensities.clear();
  for (const Eigen::Vector3f& point : scan.points)
    scan.intensities.push_back(point.z() > 0.0F ? 30.0F : 3.0F);
  map.keyframes[60].cloud = std::make_shared<const PointCloud>(scan);
  const Clouds::Cloud view = clouds_of(map, {{60}, CloudKind::view}, kSent).clouds.at(0);
  ASSERT_EQ(view.intensities.size(), view.points.size());
  for (std::size_t i = 0; i < view.points.size(); ++i) {
    const float z = view.points[i].z();
    if (std::abs(z) < static_cast<float>(kSent.voxel_m)) continue;
    EXPECT_EQ(view.intensities[i], z > 0.0F ? 30.0F : 3.0F);
  }
  EXPECT_TRUE(clouds_of(map, {{60}, CloudKind::submap}, kSent).clouds.at(0).intensities.empty());
}

TEST(OwnMapParts, ACloudSaysWhatShareOfItsScanNothingConfirmed) {
  RobotMap map = *test::in_a_tube({});
  map.unconfirmed[60] = 0.22F;
  map.unconfirmed[61].reset();
  for (const CloudKind kind : {CloudKind::view, CloudKind::submap}) {
    const Clouds sent = clouds_of(map, {{60, 61}, kind}, kSent);
    EXPECT_EQ(sent.clouds.at(0).unconfirmed, 0.22F);
    EXPECT_FALSE(sent.clouds.at(1).unconfirmed);
  }
}

TEST(OwnMapParts, ASubmapIsOneCloud) {
  const auto map = test::in_a_tube({});
  const Clouds clouds = clouds_of(*map, {{60}, CloudKind::submap}, kSent);
  ASSERT_EQ(clouds.clouds.size(), 1U);
  EXPECT_EQ(voxels_of(clouds.clouds[0].points), voxels_of(submap(*map, 60, kSent.submap).points));
  EXPECT_TRUE(clouds.clouds[0].beside.empty());
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/octomap_file.hpp"

#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include <cmath>

#include "support/files.hpp"

namespace adit {
namespace {

/// A cylinder of 2 m radius around x, 12 m long, seen from its middle; the robot stands turned at (5, 3, 1).
PlacedScan tube() {
  auto cloud = std::make_shared<PointCloud>();
  for (int i = 0; i < 360; ++i)
    for (int k = -60; k <= 60; ++k) {
      const double angle = i * 3.14159265 / 180.0;
      cloud->points.push_back(
          Vector3(0.1 * k, 2.0 * std::cos(angle), 1.0 + 2.0 * std::sin(angle)).cast<float>());
    }
  return {cloud, Vector3(0.0, 0.0, 1.0), Pose::translation_of(5.0, 3.0, 1.0) * Pose::planar(0, 0, 0.5)};
}

TEST(Octomap, IsFreeInsideATubeAndOccupiedAtItsWall) {
  const test::TemporaryFolder folder;
  const PlacedScan scan = tube();
  testing::internal::CaptureStderr();
  ASSERT_TRUE(write_octomap(folder / "tube.bt", {scan}, {.resolution_m = 0.1, .reach_m = 5.0}));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "the library's own messages";
  const octomap::OcTree tree((folder / "tube.bt").string());
  EXPECT_EQ(tree.getResolution(), 0.1);
  const auto state = [&](const Vector3& p_base) {
    const Vector3 p = scan.T_world_base * p_base;
    const octomap::OcTreeNode* node = tree.search(p.x(), p.y(), p.z());
    if (node == nullptr) return 'u';
    return tree.isNodeOccupied(node) ? 'o' : 'f';
  };
  for (const double x : {-2.5, -1.0, 0.5, 2.5}) {
    for (const double angle : {0.1, 1.3, 2.9, 4.4}) {
      const auto at = [&](double r) { return Vector3(x, r * std::cos(angle), 1.0 + r * std::sin(angle)); };
      EXPECT_EQ(state(at(1.0)), 'f') << x << " " << angle;
      EXPECT_EQ(state(at(2.0)), 'o') << x << " " << angle;
      EXPECT_EQ(state(at(2.4)), 'u') << x << " " << angle;
    }
  }
  EXPECT_EQ(state({5.5, 2.0, 1.0}), 'u') << "beyond the reach";
}

TEST(Octomap, WhatDoesNotFitIsAnError) {
  const test::TemporaryFolder folder;
  EXPECT_FALSE(write_octomap(folder / "none.bt", {}, {}));
  PlacedScan far = tube();
  far.T_world_base = Pose::translation_of(1000.0, 0.0, 0.0);
  const Result<> written = write_octomap(folder / "far.bt", {far}, {.resolution_m = 0.01});
  ASSERT_FALSE(written);
  EXPECT_NE(written.error().message.find("maps.octomap.resolution_m"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "far.bt"));
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/agreement.hpp"

#include <gtest/gtest.h>

#include "adit/registration/features.hpp"
#include "support/synthetic_scan.hpp"

namespace adit {
namespace {

// A tube with a block of rock on one side, the robot standing still at x.
OrientedPoints seen_at(const test::Scene& scene, double x, std::uint64_t seed) {
  test::Lidar lidar{64, 512, 0.6, 60.0, 0.01};
  lidar.jitter = 0.5;
  lidar.seed = seed;
  const test::Drive still{Pose::planar(x, 0.0, 0.0), Vector6::Zero()};
  return compute_surface(test::scan_of(scene, lidar, Pose(), still, 0).cloud, {});
}

test::Scene with_block() {
  test::Scene scene = test::smooth_tube();
  scene.boxes.push_back({{5.0, 1.0, -2.0}, {8.0, 4.0, 1.5}});
  return scene;
}

Agreement between(const OrientedPoints& a, const OrientedPoints& b, const Pose& T_a_b) {
  return agreement(a, KdTree(a.points), b, KdTree(b.points), T_a_b, {});
}

TEST(Agreement, OneSceneSeenFromTwoPlacesIsConfirmed) {
  const OrientedPoints a = seen_at(with_block(), 0.0, 1);
  const OrientedPoints b = seen_at(with_block(), 2.0, 2);
  const Agreement found = between(a, b, Pose::planar(2.0, 0.0, 0.0));
  EXPECT_GT(found.confirmed, 0.9);
  EXPECT_LT(found.contradicted, 0.02);
}

TEST(Agreement, ABlockThatTheOtherSawThroughContradicts) {
  const OrientedPoints a = seen_at(test::smooth_tube(), 0.0, 1);
  const OrientedPoints b = seen_at(with_block(), 2.0, 2);
  const Agreement there = between(a, b, Pose::planar(2.0, 0.0, 0.0));
  const Agreement same = between(a, seen_at(test::smooth_tube(), 2.0, 3), Pose::planar(2.0, 0.0, 0.0));
  EXPECT_GT(there.contradicted, 0.1);
  EXPECT_LT(same.contradicted, 0.02);
  EXPECT_LT(there.confirmed, same.confirmed);
}

TEST(Agreement, DoesNotDependOnWhichScanIsFirst) {
  const OrientedPoints a = seen_at(test::smooth_tube(), 0.0, 1);
  const OrientedPoints b = seen_at(with_block(), 2.0, 2);
  const Pose T_a_b = Pose::planar(2.1, 0.1, 0.02);
  const Agreement forth = between(a, b, T_a_b);
  const Agreement back = between(b, a, T_a_b.inverse());
  EXPECT_NEAR(forth.confirmed, back.confirmed, 1e-3);
  EXPECT_NEAR(forth.contradicted, back.contradicted, 1e-3);
}

TEST(Agreement, WhatHidesBehindASurfaceSaysNothing) {
  // Seen from behind the block, the tube on its other side is hidden; nothing of it counts against the pose.
  const OrientedPoints a = seen_at(with_block(), 0.0, 1);
  const OrientedPoints b = seen_at(with_block(), 12.0, 2);
  EXPECT_LT(between(a, b, Pose::planar(12.0, 0.0, 0.0)).contradicted, 0.05);
}

TEST(Agreement, OfNothingIsNothing) {
  const OrientedPoints a = seen_at(test::smooth_tube(), 0.0, 1);
  const Agreement found = between(a, {}, Pose());
  EXPECT_EQ(found.confirmed, 0.0);
  EXPECT_EQ(found.contradicted, 1.0);
}

}  // namespace
}  // namespace adit

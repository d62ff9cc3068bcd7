// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Global registration of real scans, from file to verdict.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <fstream>
#include <numbers>
#include <string>

#include "adit/core/parallel.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/registration/registration.hpp"
#include "support/data.hpp"

namespace adit {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

PointCloud cloud_at(const std::string& relative) {
  const Result<PointCloud> cloud = read_cloud(test::shared_data("registration/" + relative));
  EXPECT_TRUE(cloud.has_value()) << cloud.error().message;
  return cloud.value_or(PointCloud{});
}

Pose kitti_truth() {
  std::ifstream file(test::shared_data("registration/kitti_pair/T_target_source.txt"));
  Eigen::Matrix4d T;
  for (int k = 0; k < 16; ++k) file >> T(k / 4, k % 4);
  return Pose::from_matrix(T);
}

void expect_registered(const PointCloud& a, const PointCloud& b, const Pose& T_a_b_true) {
  const Registration r = register_clouds(a, b, {});
  ASSERT_EQ(r.verdict, LoopVerdict::accepted) << r.reason;
  const Pose error = T_a_b_true.inverse() * *r.T_a_b;
  EXPECT_LT(error.translation().norm(), 0.1) << r.reason;
  EXPECT_LT(error.angle(), 1.0 * kDegree) << r.reason;
}

TEST(RegisterRealPairs, KittiInBothDirections) {
  ADIT_NEED_DATA("registration/kitti_pair/source.ply");
  const PointCloud source = cloud_at("kitti_pair/source.ply");
  const PointCloud target = cloud_at("kitti_pair/target.ply");
  expect_registered(target, source, kitti_truth());
  expect_registered(source, target, kitti_truth().inverse());
}

TEST(RegisterRealPairs, KittiTurnedAndMovedAtWill) {
  ADIT_NEED_DATA("registration/kitti_pair/source.ply");
  const PointCloud source = cloud_at("kitti_pair/source.ply");
  const PointCloud target = cloud_at("kitti_pair/target.ply");
  for (const Vector3& axis : {Vector3(0, 0, 1), Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(1, -2, 1)}) {
    const Eigen::AngleAxisd turn(120.0 * kDegree, axis.normalized());
    const Pose T_new_old(Eigen::Quaterniond(turn), Vector3(4.0, -3.0, 0.0));
    expect_registered(target, transformed(T_new_old, source), kitti_truth() * T_new_old.inverse());
  }
}

TEST(RegisterRealPairs, OutdoorPairAgreesWithItsReverse) {
  ADIT_NEED_DATA("registration/ndt_omp_pair/251370668.pcd");
  const PointCloud a = cloud_at("ndt_omp_pair/251370668.pcd");
  const PointCloud b = cloud_at("ndt_omp_pair/251371071.pcd");
  const Registration ab = register_clouds(a, b, {});
  const Registration ba = register_clouds(b, a, {});
  ASSERT_EQ(ab.verdict, LoopVerdict::accepted) << ab.reason;
  ASSERT_EQ(ba.verdict, LoopVerdict::accepted) << ba.reason;
  const Pose round_trip = *ab.T_a_b * *ba.T_a_b;
  EXPECT_LT(round_trip.translation().norm(), 0.05);
  EXPECT_LT(round_trip.angle(), 0.2 * kDegree);
}

TEST(RegisterRealPairs, SameBytesOnEveryRunAndWithAnyNumberOfThreads) {
  ADIT_NEED_DATA("registration/kitti_pair/source.ply");
  const PointCloud source = cloud_at("kitti_pair/source.ply");
  const PointCloud target = cloud_at("kitti_pair/target.ply");
  const int threads_before = num_threads();
  set_num_threads(1);
  const Registration one = register_clouds(target, source, {});
  set_num_threads(3);
  const Registration three = register_clouds(target, source, {});
  set_num_threads(threads_before);
  EXPECT_EQ(one.T_a_b->matrix(), three.T_a_b->matrix());
  EXPECT_EQ(one.information, three.information);
  EXPECT_EQ(one.reason, three.reason);
}

TEST(RegisterRealPairs, PlacesFarApartAreRejected) {
  ADIT_NEED_DATA("registration/kitti_pair/source.ply");
  ADIT_NEED_DATA("scans/nclt");
  const Result<PointCloud> campus = read_cloud(test::shared_data("scans/nclt") / "0150.pcd");
  ASSERT_TRUE(campus) << campus.error().message;
  const Registration r = register_clouds(cloud_at("kitti_pair/target.ply"), *campus, {});
  EXPECT_EQ(r.verdict, LoopVerdict::rejected);
  EXPECT_FALSE(r.reason.empty());
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/point_cloud.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

TEST(PointCloud, TransformedMovesPointsAndKeepsTheRest) {
  PointCloud cloud;
  cloud.points = {{1, 0, 0}, {0, 2, 0}};
  cloud.intensities = {7, 8};
  cloud.time_offsets_ns = {-5, 0};
  const PointCloud moved = transformed(Pose::planar(10, 0, 1.5707963267948966), cloud);
  EXPECT_TRUE(moved.points[0].isApprox(Eigen::Vector3f(10, 1, 0), 1e-6F));
  EXPECT_TRUE(moved.points[1].isApprox(Eigen::Vector3f(8, 0, 0), 1e-6F));
  EXPECT_EQ(moved.intensities, cloud.intensities);
  EXPECT_EQ(moved.time_offsets_ns, cloud.time_offsets_ns);
  EXPECT_TRUE(transformed(Pose::planar(1, 2, 3), {}).empty());
}

TEST(PointCloud, AppendPutsZerosWhereOnlyOneHasIntensities) {
  const PointCloud without{{{1.0F, 0.0F, 0.0F}}, {}, {}};
  const PointCloud with{{{2.0F, 0.0F, 0.0F}, {3.0F, 0.0F, 0.0F}}, {7.0F, 80.0F}, {1, 2}};
  PointCloud all = without;
  append(all, with);
  append(all, without);
  all.check();
  EXPECT_EQ(all.size(), 4U);
  EXPECT_EQ(all.intensities, (std::vector<float>{0.0F, 7.0F, 80.0F, 0.0F}));
  EXPECT_FALSE(all.has_times());
  PointCloud none = without;
  append(none, without);
  EXPECT_EQ(none.size(), 2U);
  EXPECT_TRUE(none.intensities.empty());
}

TEST(PointCloud, CheckWantsOneValueAPointOrNone) {
  PointCloud cloud;
  cloud.points = {{1, 0, 0}, {0, 2, 0}};
  EXPECT_NO_THROW(cloud.check());
  cloud.intensities = {1};
  EXPECT_THROW(cloud.check(), ContractViolation);
  cloud.intensities = {1, 2};
  cloud.time_offsets_ns = {1, 2, 3};
  EXPECT_THROW(cloud.check(), ContractViolation);
}

}  // namespace
}  // namespace adit

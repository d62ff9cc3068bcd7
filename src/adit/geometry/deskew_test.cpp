// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/deskew.hpp"

#include <gtest/gtest.h>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

const ConstantVelocity kMotion{Pose(so3::exp({0.02, -0.01, 0.3}), Vector3(0.5, 0.1, -0.02)),
                               std::chrono::milliseconds(100)};

TEST(ConstantVelocity, PassesThroughStartAndEnd) {
  EXPECT_LT((kMotion.pose_after(kMotion.duration).matrix() - kMotion.T_start_end.matrix()).norm(), 1e-12);
  EXPECT_LT((kMotion.pose_after(-kMotion.duration).matrix() - kMotion.T_start_end.inverse().matrix()).norm(),
            1e-12);
  EXPECT_LT((kMotion.pose_after({}).matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-15);
  EXPECT_THROW(static_cast<void>(ConstantVelocity{}.pose_after({})), ContractViolation);
}

// Fixed landmarks seen while moving must come out where they are seen from the pose at the stamp.
TEST(Deskewed, PutsLandmarksBack) {
  Rng rng(5);
  PointCloud cloud;
  std::vector<Vector3> landmarks;
  for (int i = 0; i < 2000; ++i) {
    const auto offset =
        static_cast<std::int32_t>(rng.below(150'000'000)) - 100'000'000;  // also after the stamp
    landmarks.emplace_back(rng.uniform(-80, 80), rng.uniform(-80, 80), rng.uniform(-5, 5));
    cloud.points.emplace_back(
        (kMotion.pose_after(Duration(offset)).inverse() * landmarks.back()).cast<float>());
    cloud.time_offsets_ns.push_back(offset);
  }
  const PointCloud straight = deskewed(cloud, kMotion);
  ASSERT_EQ(straight.size(), cloud.size());
  EXPECT_FALSE(straight.has_times());
  for (std::size_t i = 0; i < landmarks.size(); ++i)
    EXPECT_LT((straight.points[i].cast<double>() - landmarks[i]).norm(), 1e-3) << i;
}

TEST(Deskewed, WithoutTimesNothingChanges) {
  const PointCloud cloud{{{1, 2, 3}}, {0.5F}, {}};
  EXPECT_EQ(deskewed(cloud, kMotion).points, cloud.points);
  EXPECT_TRUE(deskewed({}, kMotion).empty());
}

TEST(Deskewed, OneCommonTimeAndNoMotion) {
  const PointCloud cloud{{{1, 2, 3}, {4, 5, 6}}, {}, {-50'000'000, -50'000'000}};
  const Vector3 expected = kMotion.pose_after(std::chrono::milliseconds(-50)) * Vector3(1, 2, 3);
  EXPECT_LT((deskewed(cloud, kMotion).points[0].cast<double>() - expected).norm(), 1e-6);
  const PointCloud still = deskewed(cloud, {Pose(), std::chrono::milliseconds(100)});
  EXPECT_EQ(still.points, cloud.points);
}

}  // namespace
}  // namespace adit

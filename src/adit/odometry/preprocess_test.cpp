// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/preprocess.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "adit/core/parallel.hpp"
#include "adit/core/rng.hpp"
#include "support/synthetic_scan.hpp"

namespace adit {
namespace {

using test::kMount;
const ConstantVelocity kMotion{Pose(so3::exp({0.0, 0.01, 0.2}), Vector3(0.4, 0.0, 0.1)),
                               std::chrono::milliseconds(100)};

// Dense and sparse stretches, echoes at zero, NaN.
PointCloud raw_cloud(std::size_t n) {
  Rng rng(8);
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const double reach = i % 3000 < 1500 ? 20.0 : 60.0;
    cloud.points.push_back(
        Vector3(rng.uniform(-reach, reach), rng.uniform(-reach, reach), rng.uniform(-3, 3)).cast<float>());
    if (i % 977 == 0) cloud.points.back().setZero();
    if (i % 1013 == 0) cloud.points.back().y() = std::numeric_limits<float>::quiet_NaN();
    cloud.intensities.push_back(static_cast<float>(i));
    cloud.time_offsets_ns.push_back(static_cast<std::int32_t>(i % 1024) * 97'000 - 99'400'000);
  }
  return cloud;
}

// The definition, point by point.
PointCloud expected(const PointCloud& raw, const RangeLimits& limits, bool deskew) {
  PointCloud out;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const Vector3 p = raw.points[i].cast<double>();
    if (!(p.norm() > limits.min_range && p.norm() < limits.max_range)) continue;
    const Pose T = deskew ? kMotion.pose_after(Duration(raw.time_offsets_ns[i])) * kMount : kMount;
    out.points.push_back((T * p).cast<float>());
    out.intensities.push_back(raw.intensities[i]);
  }
  return out;
}

TEST(Preprocess, CropsMovesAndDeskews) {
  const PointCloud raw = raw_cloud(40'000);
  const RangeLimits limits = {1.0, 50.0};
  PointCloud cloud = raw_cloud(10);  // what it held is gone
  for (const bool deskew : {false, true}) {
    preprocess(raw, limits, kMount, deskew ? std::optional(sweep_of(kMotion)) : std::nullopt, cloud);
    const PointCloud oracle = expected(raw, limits, deskew);
    ASSERT_EQ(cloud.size(), oracle.size());
    EXPECT_EQ(cloud.intensities, oracle.intensities);
    for (std::size_t i = 0; i < cloud.size(); ++i)
      ASSERT_LT((cloud.points[i] - oracle.points[i]).norm(), 4e-4F) << i;
  }
}

TEST(Preprocess, SameWithAnyNumberOfThreadsAndWithoutIntensities) {
  PointCloud raw = raw_cloud(40'000);
  PointCloud one;
  PointCloud two;
  const int before = num_threads();
  set_num_threads(1);
  preprocess(raw, {1.0, 50.0}, kMount, sweep_of(kMotion), one);
  set_num_threads(2);
  raw.intensities.clear();
  preprocess(raw, {1.0, 50.0}, kMount, sweep_of(kMotion), two);
  set_num_threads(before);
  EXPECT_EQ(one.points, two.points);
  EXPECT_TRUE(two.intensities.empty());
}

TEST(Preprocess, NothingLeft) {
  PointCloud cloud = raw_cloud(10);
  preprocess({}, {}, kMount, sweep_of(kMotion), cloud);
  EXPECT_TRUE(cloud.empty());
  preprocess(raw_cloud(100), {90.0, 100.0}, kMount, sweep_of(kMotion), cloud);
  EXPECT_TRUE(cloud.empty());
  EXPECT_TRUE(cloud.intensities.empty());
}

}  // namespace
}  // namespace adit

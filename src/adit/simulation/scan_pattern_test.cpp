// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/scan_pattern.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "adit/core/angles.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

const Raycaster& hall_caster() {
  static const Raycaster caster = Raycaster::build(test::room({-30, -30, -30}, {30, 30, 30})).value();
  return caster;
}

/// What a standing sensor sees in scan `index`, without noise and losses.
PointCloud seen(LidarConfig config, int index) {
  config.noise_near = config.noise_far = 0.0;
  config.dropout_start_deg = 89.9;
  config.dropout_end_deg = 90.0;
  const Stamp end = Stamp{1'700'000'000'000'000'000} + index * sweep_time(config);
  return cast_scan(hall_caster(), config, {Pose(), Pose(), end, 1}).cloud;
}

/// The share of the cells of one degree inside the field of view, a cone about x, that scans have met.
double coverage_of_cone(const LidarConfig& config, int num_scans) {
  const double half = config.elevation_max_deg;
  std::set<std::pair<int, int>> cells;
  std::set<std::pair<int, int>> met;
  for (int i = -80; i <= 80; ++i)
    for (int k = -80; k <= 80; ++k)
      if (std::hypot(i, k) < half - 1.0) cells.emplace(i, k);
  for (int index = 0; index < num_scans; ++index) {
    for (const Eigen::Vector3f& point : seen(config, index).points) {
      const Vector3 d = point.cast<double>().normalized();
      const double off = std::acos(std::clamp(d.x(), -1.0, 1.0)) / kDegree;
      const double scale = off / std::max(1e-12, std::hypot(d.y(), d.z()));
      const std::pair cell(static_cast<int>(std::lround(scale * d.y())),
                           static_cast<int>(std::lround(scale * d.z())));
      if (cells.contains(cell)) met.insert(cell);
    }
  }
  return static_cast<double>(met.size()) / static_cast<double>(cells.size());
}

TEST(ScanPattern, ARosetteFillsItsConeWithTime) {
  const LidarConfig mid40 = lidar_preset("livox-mid-40").value();
  EXPECT_EQ(seen(mid40, 0).size(), 10'000U);
  double widest = 0.0;
  for (const Eigen::Vector3f& point : seen(mid40, 3).points)
    widest = std::max(widest, std::acos(double(point.normalized().x())) / kDegree);
  EXPECT_LT(widest, 19.2 + 1e-3);
  EXPECT_GT(widest, 18.8);
  const double one = coverage_of_cone(mid40, 1);
  const double ten = coverage_of_cone(mid40, 10);
  EXPECT_GT(one, 0.2);
  EXPECT_LT(one, 0.95);
  EXPECT_GT(ten, 0.97);
  EXPECT_GT(ten, one + 0.05);
}

TEST(ScanPattern, TheTwoPrismsAddUp) {
  LidarConfig c = lidar_preset("livox-mid-40").value();
  c.first_rpm = 60.0;
  c.second_rpm = -60.0;
  // Both point to the left, then against one another, then both to the right.
  const double edge = c.elevation_max_deg * kDegree;
  EXPECT_LT((pattern_direction(c, Stamp{}) - Vector3(std::cos(edge), std::sin(edge), 0)).norm(), 1e-12);
  EXPECT_LT((pattern_direction(c, Stamp{250'000'000}) - Vector3(1, 0, 0)).norm(), 1e-9);
  EXPECT_LT((pattern_direction(c, Stamp{500'000'000}) - Vector3(std::cos(edge), -std::sin(edge), 0)).norm(),
            1e-9);
}

TEST(ScanPattern, ScansDoNotRepeatAndStampsOfTodayLoseNoDigits) {
  for (const char* name : {"livox-mid-40", "livox-avia", "livox-mid-360"}) {
    const LidarConfig c = lidar_preset(name).value();
    const PointCloud first = seen(c, 0);
    const PointCloud second = seen(c, 1);
    double apart = 0.0;
    for (std::size_t i = 0; i < 1000; ++i)
      apart += (first.points[i].normalized() - second.points[i].normalized()).norm() / 1000.0;
    EXPECT_GT(apart, 0.01) << name;
    // Neighbouring rays stay neighbours: the phases are smooth.
    const Stamp now{1'700'000'000'000'000'000};
    for (int i = 0; i < 100; ++i) {
      const Vector3 a = pattern_direction(c, now + Duration(i * 1000));
      const Vector3 b = pattern_direction(c, now + Duration((i + 1) * 1000));
      EXPECT_GT((a - b).norm(), 1e-6) << name;
      EXPECT_LT((a - b).norm(), 2e-3) << name;
    }
  }
}

TEST(ScanPattern, AWaveCoversAllAroundWithinItsElevations) {
  const LidarConfig mid360 = lidar_preset("livox-mid-360").value();
  std::set<std::pair<int, int>> cells;
  double one = 0.0;
  for (int index = 0; index < 10; ++index) {
    const PointCloud cloud = seen(mid360, index);
    EXPECT_EQ(cloud.size(), 20'000U);
    for (const Eigen::Vector3f& point : cloud.points) {
      const double elevation = std::asin(double(point.normalized().z())) / kDegree;
      ASSERT_GT(elevation, -7.01);
      ASSERT_LT(elevation, 52.01);
      const double azimuth = std::atan2(double(point.y()), double(point.x())) / kDegree;
      cells.emplace(static_cast<int>(std::floor(azimuth / 2.0)),
                    static_cast<int>(std::floor((elevation + 7.0) / 2.0)));
    }
    if (index == 0) one = static_cast<double>(cells.size());
  }
  const double all = 180.0 * 29.5;
  EXPECT_GT(static_cast<double>(cells.size()) / all, 0.9);
  EXPECT_GT(static_cast<double>(cells.size()), 1.2 * one);
}

TEST(ScanPattern, ANarrowFieldOfViewOfASpinningSensor) {
  const LidarConfig whole = lidar_preset("os1-64").value();
  const LidarConfig front = lidar_preset("os1-64-front").value();
  const PointCloud cloud = seen(front, 0);
  const PointCloud all = seen(whole, 0);
  EXPECT_NEAR(static_cast<double>(cloud.size()) / static_cast<double>(all.size()), 0.25, 0.002);
  for (const Eigen::Vector3f& point : cloud.points)
    ASSERT_LE(std::abs(std::atan2(point.y(), point.x())), 45.001 * kDegree);
  // What it sees is what the whole turn sees there, at the same times.
  std::size_t k = 0;
  for (std::size_t i = 0; i < all.size() && k < cloud.size(); ++i) {
    if (all.points[i] != cloud.points[k]) continue;
    ASSERT_EQ(all.time_offsets_ns[i], cloud.time_offsets_ns[k]);
    ++k;
  }
  EXPECT_EQ(k, cloud.size());
}

}  // namespace
}  // namespace adit

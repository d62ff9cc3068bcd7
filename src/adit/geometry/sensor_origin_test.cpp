// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/sensor_origin.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// A rough tunnel, 5 m wide, from 0.9 m below the sensor to 2.5 m above it, seen by evenly spaced beams of a
/// turning LiDAR; `sensor` is where it stands in the frame of the cloud.
PointCloud tunnel_scan(int num_beams, double half_view_deg, const Vector3& sensor, std::uint64_t seed) {
  Rng rng(seed);
  const double heading = rng.uniform(-3.0, 3.0);
  PointCloud cloud;
  for (int column = 0; column < 720; ++column) {
    const double azimuth = column * 0.5 * kDegree;
    for (int beam = 0; beam < num_beams; ++beam) {
      const double elevation = kDegree * half_view_deg * (2.0 * beam / (num_beams - 1) - 1.0);
      const Vector3 ray(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                        std::sin(elevation));
      const double across = -std::sin(heading) * ray.x() + std::cos(heading) * ray.y();
      const double to_wall = (across > 0.0 ? 2.0 : 3.0) / std::max(1e-3, std::abs(across));
      const double to_floor_or_roof = (ray.z() < 0.0 ? 0.9 : 2.5) / std::max(1e-3, std::abs(ray.z()));
      const double rough = 1.0 + 0.05 * std::sin(7.0 * azimuth) + 0.03 * std::sin(40.0 * elevation);
      const double range = std::min(to_wall, to_floor_or_roof) * rough + 0.02 * rng.normal();
      if (range > 60.0) continue;
      cloud.points.push_back((sensor + range * ray).cast<float>());
    }
  }
  return cloud;
}

struct SensorCase {
  const char* name;
  int num_beams;
  double half_view_deg;
};
class SensorOrigins : public ::testing::TestWithParam<SensorCase> {
 protected:
  [[nodiscard]] static std::vector<PointCloud> scans_from(const Vector3& sensor) {
    std::vector<PointCloud> clouds;
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
      clouds.push_back(tunnel_scan(GetParam().num_beams, GetParam().half_view_deg, sensor, seed));
    return clouds;
  }
};

TEST_P(SensorOrigins, AreFoundWhereverTheCloudsHaveTheirOrigin) {
  for (const Vector3& sensor :
       {Vector3(0, 0, 0), Vector3(0, 0, 0.9), Vector3(0.42, -0.13, 1.37), Vector3(-0.3, 0, -0.6)}) {
    const std::vector<PointCloud> clouds = scans_from(sensor);
    const auto found = find_sensor_origin(clouds);
    ASSERT_TRUE(found) << sensor.transpose();
    EXPECT_LT((found->position - sensor).norm(), 0.005) << found->position.transpose();
    EXPECT_GT(found->contrast, 1.2 * kClearContrast);
  }
}

TEST_P(SensorOrigins, AreNotFoundInCloudsThatShareNone) {
  std::vector<PointCloud> clouds;
  Rng rng(3);
  for (const PointCloud& cloud : scans_from(Vector3::Zero())) {
    const Vector3 shift(rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5));
    clouds.push_back(transformed(Pose(Eigen::Quaterniond::Identity(), shift), cloud));
  }
  const auto found = find_sensor_origin(clouds);
  EXPECT_FALSE(found) << found->position.transpose() << ", contrast " << found->contrast;
}

INSTANTIATE_TEST_SUITE_P(All, SensorOrigins,
                         ::testing::Values(SensorCase{"beams_16", 16, 15.0},
                                           SensorCase{"beams_32", 32, 11.25},
                                           SensorCase{"beams_64", 64, 16.6},
                                           SensorCase{"beams_128", 128, 11.25}),
                         [](const auto& item) { return item.param.name; });

TEST(SensorOrigin, IsNotFoundWithoutBeams) {
  Rng rng(4);
  PointCloud cloud;
  for (const Eigen::Vector3f& point : tunnel_scan(64, 16.6, Vector3::Zero(), 1).points)
    cloud.points.push_back(point * static_cast<float>(rng.uniform(0.9, 1.0)) +
                           Eigen::Vector3f(0, 0, static_cast<float>(rng.uniform(-0.1, 0.1))));
  EXPECT_FALSE(find_sensor_origin(std::vector{cloud, cloud}));
  EXPECT_FALSE(find_sensor_origin({}));
  PointCloud few;
  few.points.assign(5, {1, 2, 3});
  EXPECT_FALSE(find_sensor_origin(std::vector{few, few}));
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/lidar_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "adit/core/parallel.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

const Vector3 kLow(-6.0, -4.0, -1.0);
const Vector3 kHigh(7.0, 3.0, 2.0);

Raycaster room_caster() { return Raycaster::build(test::room(kLow, kHigh)).value(); }

LidarConfig noiseless() {
  LidarConfig c = lidar_preset("os2-32").value();
  c.noise_near = c.noise_far = 0.0;
  c.dropout_start_deg = 89.99;
  c.dropout_end_deg = 90.0;
  return c;
}

Sweep standing(const Pose& T_world_lidar, std::uint64_t seed = 1) {
  return {T_world_lidar, T_world_lidar, Stamp{5'000'000'000}, seed};
}

// Distance of a point in the world from the nearest side of the room.
double off_the_walls(const Vector3& p) {
  return std::min((p - kLow).cwiseAbs().minCoeff(), (p - kHigh).cwiseAbs().minCoeff());
}

TEST(LidarModel, measures_exactly_what_geometry_says) {
  const LidarConfig c = noiseless();
  const Scan scan = cast_scan(room_caster(), c, standing(Pose()));
  ASSERT_EQ(scan.cloud.size(), static_cast<std::size_t>(c.beams * c.columns));
  EXPECT_EQ(scan.stamp, Stamp{5'000'000'000});
  for (int column = 0; column < c.columns; column += 7) {
    for (int beam = 0; beam < c.beams; ++beam) {
      const double azimuth = std::numbers::pi * (1.0 - 2.0 * column / c.columns);
      const double elevation = (11.25 - 22.5 * beam / (c.beams - 1)) * std::numbers::pi / 180.0;
      const Vector3 direction(std::cos(elevation) * std::cos(azimuth),
                              std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      double range = 1e9;
      for (int axis = 0; axis < 3; ++axis) {
        const double wall = direction[axis] > 0.0 ? kHigh[axis] : kLow[axis];
        if (std::abs(direction[axis]) > 1e-12) range = std::min(range, wall / direction[axis]);
      }
      const Eigen::Vector3f& point = scan.cloud.points[static_cast<std::size_t>(column * c.beams + beam)];
      EXPECT_LT((point.cast<double>() - range * direction).norm(), 1e-4);
    }
  }
}

TEST(LidarModel, times_run_from_minus_one_turn_to_the_stamp) {
  const LidarConfig c = noiseless();
  const PointCloud cloud = cast_scan(room_caster(), c, standing(Pose())).cloud;
  cloud.check();
  ASSERT_TRUE(cloud.has_times());
  EXPECT_TRUE(std::ranges::is_sorted(cloud.time_offsets_ns));
  EXPECT_EQ(cloud.time_offsets_ns.back(), 0);
  EXPECT_EQ(cloud.time_offsets_ns.front(), -100'000'000LL * (c.columns - 1) / c.columns);
}

// A step of 20 cm in a wall 8 m ahead, its edge upright or level.
std::ptrdiff_t num_mixed_at(bool upright) {
  TriangleMesh mesh;
  test::add_quad(mesh, {8, -9, -9}, {8, -9, 9}, {8, 9, 9}, {8, 9, -9});
  if (upright)
    test::add_quad(mesh, {7.8, 0, -9}, {7.8, 0, 9}, {7.8, 9, 9}, {7.8, 9, -9});
  else
    test::add_quad(mesh, {7.8, -9, 0}, {7.8, -9, 9}, {7.8, 9, 9}, {7.8, 9, 0});
  LidarUnit unit;
  unit.divergence_factor = 10.0;
  const Raycaster world = Raycaster::build(mesh).value();
  LidarConfig config = noiseless();
  config.beams = 129;  // more than a block
  return std::ranges::count_if(
      cast_scan(world, config, standing(Pose()), unit).cloud.points,
      [](const Eigen::Vector3f& p) { return p.x() > 7.83F && p.x() < 7.97F && p.tail<2>().norm() < 2.5F; });
}

TEST(LidarModel, beams_with_a_width_mix_both_sides_of_upright_and_of_level_edges) {
  EXPECT_GT(num_mixed_at(true), 40);
  EXPECT_GT(num_mixed_at(false), 40);
}

TEST(LidarModel, deskewing_with_the_true_motion_restores_the_walls) {
  const LidarConfig c = noiseless();
  const Pose start = Pose::planar(-1.0, 0.5, 0.3);
  const Pose end = start * Pose::exp((Vector6() << 0.19, 0.01, 0.005, 0.01, -0.02, 0.15).finished());
  const PointCloud cloud = cast_scan(room_caster(), c, {start, end, Stamp{}, 1}).cloud;
  double worst = 0.0;
  double worst_undistorted = 0.0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vector3 p = cloud.points[i].cast<double>();
    const double s = 1.0 + 1e-9 * cloud.time_offsets_ns[i] / to_seconds(sweep_time(c));
    worst = std::max(worst, off_the_walls(interpolate(start, end, s) * p));
    worst_undistorted = std::max(worst_undistorted, off_the_walls(end * p));
  }
  EXPECT_LT(worst, 1e-3);
  EXPECT_GT(worst_undistorted, 0.1);
}

TEST(LidarModel, range_noise_grows_with_range_as_configured) {
  LidarConfig c = noiseless();
  c.noise_near = 0.02;
  c.noise_far = 0.10;
  c.range_max = 100.5;
  c.elevation_max_deg = 0.01;
  c.elevation_min_deg = -0.01;
  for (const double distance : {2.0, 50.0, 95.0}) {
    // A long slab: only returns from the wall straight ahead count.
    const Raycaster raycaster =
        Raycaster::build(test::room({-distance, -distance, -distance}, {distance, distance, distance}))
            .value();
    double sum = 0.0;
    double sum_of_squares = 0.0;
    double n = 0.0;
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      const PointCloud noisy = cast_scan(raycaster, c, standing(Pose(), seed)).cloud;
      for (const Eigen::Vector3f& p : noisy.points) {
        const Vector3 direction = p.cast<double>().normalized();
        const double range = distance / direction.cwiseAbs().maxCoeff();
        if (range > 1.02 * distance) continue;
        const double error = static_cast<double>(p.norm()) - range;
        sum += error;
        sum_of_squares += error * error;
        ++n;
      }
    }
    const double sigma = 0.02 + 0.08 * (1.01 * distance - 0.5) / 100.0;
    ASSERT_GT(n, 10000.0);
    EXPECT_NEAR(sum / n, 0.0, 4.0 * sigma / std::sqrt(n));
    EXPECT_NEAR(std::sqrt(sum_of_squares / n), sigma, 0.03 * sigma);
  }
}

TEST(LidarModel, returns_get_lost_at_grazing_incidence) {
  LidarConfig c = noiseless();
  c.dropout_start_deg = 30.0;
  c.dropout_end_deg = 60.0;
  c.elevation_min_deg = -75.0;
  c.elevation_max_deg = -15.0;
  c.beams = 61;  // one per degree: incidence on the floor is 90 deg plus elevation
  TriangleMesh floor;
  test::add_quad(floor, {-90, -90, -1}, {90, -90, -1}, {90, 90, -1}, {-90, 90, -1});
  const PointCloud cloud = cast_scan(Raycaster::build(floor).value(), c, standing(Pose())).cloud;
  std::vector<double> returned(91);
  for (const Eigen::Vector3f& p : cloud.points) {
    ++returned[static_cast<std::size_t>(std::lround(std::acos(-p.normalized().z()) * 180.0F / 3.14159265F))];
  }
  for (std::size_t incidence = 15; incidence <= 75; ++incidence) {
    const double expected = std::clamp((60.0 - static_cast<double>(incidence)) / 30.0, 0.0, 1.0);
    EXPECT_NEAR(returned[incidence] / c.columns, expected, 0.1) << incidence;
  }
}

TEST(LidarModel, reports_only_ranges_between_its_limits) {
  LidarConfig c = noiseless();
  c.range_min = 4.5;
  c.range_max = 6.0;
  const PointCloud cloud = cast_scan(room_caster(), c, standing(Pose())).cloud;
  EXPECT_LT(cloud.size(), static_cast<std::size_t>(c.beams * c.columns));
  ASSERT_FALSE(cloud.empty());
  for (const Eigen::Vector3f& p : cloud.points) {
    EXPECT_GE(p.norm(), 4.5F - 1e-5F);
    EXPECT_LE(p.norm(), 6.0F + 1e-5F);
  }
}

TEST(LidarModel, a_scan_depends_on_its_seed_and_not_on_threads) {
  const Raycaster raycaster = room_caster();
  const LidarConfig c = lidar_preset("os2-32").value();
  const int threads_before = num_threads();
  set_num_threads(1);
  const PointCloud one = cast_scan(raycaster, c, standing(Pose(), 3)).cloud;
  set_num_threads(4);
  const PointCloud four = cast_scan(raycaster, c, standing(Pose(), 3)).cloud;
  set_num_threads(threads_before);
  EXPECT_EQ(one.points, four.points);
  EXPECT_EQ(one.time_offsets_ns, four.time_offsets_ns);
  EXPECT_NE(one.points, cast_scan(raycaster, c, standing(Pose(), 4)).cloud.points);
}

TEST(LidarModel, one_beam_and_few_columns_will_do) {
  LidarConfig c = noiseless();
  c.beams = 1;
  c.columns = 4;
  c.elevation_min_deg = c.elevation_max_deg = 0.0;
  const PointCloud cloud = cast_scan(room_caster(), c, standing(Pose())).cloud;
  ASSERT_EQ(cloud.size(), 4U);  // back, left, ahead, right
  EXPECT_NEAR(cloud.points[0].x(), -6.0F, 1e-5F);
  EXPECT_NEAR(cloud.points[1].y(), 3.0F, 1e-5F);
  EXPECT_NEAR(cloud.points[2].x(), 7.0F, 1e-5F);
  EXPECT_NEAR(cloud.points[3].y(), -4.0F, 1e-5F);
}

TEST(LidarModel, presets_are_sound_and_listed_when_the_name_is_unknown) {
  for (const std::string& name : lidar_presets()) {
    const Result<LidarConfig> preset = lidar_preset(name);
    ASSERT_TRUE(preset.has_value()) << name;
    EXPECT_EQ(preset->name, name);
    EXPECT_TRUE(check_lidar(*preset).has_value()) << name;
  }
  EXPECT_EQ(lidar_preset("os2-128-2048")->columns, 2048);
  const Result<LidarConfig> unknown = lidar_preset("os3");
  ASSERT_FALSE(unknown.has_value());
  EXPECT_NE(unknown.error().message.find("vlp-16"), std::string::npos);
}

TEST(LidarModel, contradictory_configurations_are_refused) {
  LidarConfig c;
  c.range_min = 50.0;
  c.range_max = 10.0;
  EXPECT_FALSE(check_lidar(c).has_value());
  EXPECT_THROW(static_cast<void>(cast_scan(room_caster(), c, standing(Pose()))), ContractViolation);
  c = LidarConfig();
  c.elevation_min_deg = 20.0;
  EXPECT_FALSE(check_lidar(c).has_value());
  c = LidarConfig();
  c.rate_hz = 0.0;
  EXPECT_FALSE(check_lidar(c).has_value());
}

}  // namespace
}  // namespace adit

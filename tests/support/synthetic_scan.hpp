// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Scans of analytic scenes, for tests and benchmarks of odometry: no mesh, no file, exact truth.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/core/rng.hpp"

namespace adit::test {

/// Where the LiDAR sits on the base: turned and shifted along every axis.
inline const Pose kMount(so3::exp({0.02, -0.03, 0.1}), Vector3(0.3, 0.1, 0.5));

struct Box {
  Vector3 low;
  Vector3 high;
};

/// A round tube along x with a flat floor, or a room (the inside of `room`), with boxes in it. World frame.
struct Scene {
  double tube_radius = 0.0;  ///< 0: no tube.
  double floor_z = -std::numeric_limits<double>::infinity();
  std::vector<Box> rooms;  ///< At most one: its inner faces.
  std::vector<Box> boxes;  ///< Their outer faces.
};

/// Distance along the ray to the first surface; infinity when there is none.
inline double cast(const Scene& scene, const Vector3& origin, const Vector3& direction) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  double nearest = kNone;
  const auto slabs = [&](const Box& box) {
    const Eigen::Array3d a = (box.low - origin).array() / direction.array();
    const Eigen::Array3d b = (box.high - origin).array() / direction.array();
    return std::pair(a.min(b).maxCoeff(), a.max(b).minCoeff());
  };
  for (const Box& room : scene.rooms) nearest = std::min(nearest, slabs(room).second);
  for (const Box& box : scene.boxes) {
    const auto [enter, leave] = slabs(box);
    if (enter > 0.0 && enter < leave) nearest = std::min(nearest, enter);
  }
  if (scene.tube_radius > 0.0) {
    const double a = direction.tail<2>().squaredNorm();
    const double b = origin.tail<2>().dot(direction.tail<2>());
    const double c = origin.tail<2>().squaredNorm() - scene.tube_radius * scene.tube_radius;
    if (a > 0.0) nearest = std::min(nearest, (-b + std::sqrt(b * b - a * c)) / a);
  }
  if (direction.z() < 0.0) nearest = std::min(nearest, (scene.floor_z - origin.z()) / direction.z());
  return nearest;
}

struct Lidar {
  int rows = 32;
  int columns = 256;
  double half_fov = 0.35;  ///< Radians above and below the horizon.
  double max_range = 120.0;
  double noise = 0.01;  ///< Metres, one sigma.
  Duration period = std::chrono::milliseconds(100);
  std::uint64_t seed = 7;
  /// How far each ray strays from its cell's centre, in cells: 0.5 samples surfaces evenly at random, 0
  /// repeats the same pattern in each scan, onto which point-to-point residuals lock where a surface is
  /// smooth.
  double jitter = 0.0;
};

/// One sweep that ends at `stamp`, while the base moves as `base_at(offset)` (T_world_base, offset <= 0 from
/// the stamp). Points come row by row, as drivers publish organised clouds.
template <class BaseAt>
Scan sweep(const Scene& scene, const Lidar& lidar, const Pose& T_base_lidar, Stamp stamp,
           const BaseAt& base_at) {
  std::vector<Pose> T_world_lidar;
  std::vector<Duration> offsets;
  for (int column = 0; column < lidar.columns; ++column) {
    offsets.push_back(lidar.period * (column + 1 - lidar.columns) / lidar.columns);
    T_world_lidar.push_back(base_at(offsets.back()) * T_base_lidar);
  }
  Rng rng(mix64(lidar.seed, static_cast<std::uint64_t>(stamp.ns)));
  const auto stray = [&] { return lidar.jitter > 0.0 ? rng.uniform(-lidar.jitter, lidar.jitter) : 0.0; };
  Scan scan{stamp, {}};
  for (int i = 0; i < lidar.rows * lidar.columns; ++i) {
    const auto column = static_cast<std::size_t>(i % lidar.columns);
    const double azimuth = -2.0 * std::numbers::pi * (static_cast<double>(column) + stray()) / lidar.columns;
    const double row = i / lidar.columns + 0.5 + stray();
    const double elevation = lidar.half_fov * (1.0 - 2.0 * row / lidar.rows);
    const Vector3 ray(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                      std::sin(elevation));
    const Pose& T = T_world_lidar[column];
    const double range = cast(scene, T.translation(), T.rotation() * ray);
    if (!(range < lidar.max_range)) continue;
    scan.cloud.points.emplace_back(((range + lidar.noise * rng.normal()) * ray).cast<float>());
    scan.cloud.intensities.push_back(1.0F);
    scan.cloud.time_offsets_ns.push_back(static_cast<std::int32_t>(offsets[column].count()));
  }
  return scan;
}

/// A drive that starts from rest and takes up the constant body twist `velocity` (per second) within about a
/// second, so that no first scan is skewed.
struct Drive {
  Pose T_world_start;
  Vector6 velocity = Vector6::Zero();

  [[nodiscard]] Pose at(double seconds) const {
    const double eased = seconds > 0.0 ? seconds - 1.0 + std::exp(-seconds) : 0.0;
    return T_world_start * Pose::exp(eased * velocity);
  }
};

/// Scan `index` of a drive; scan 0 is taken at time 0.
inline Scan scan_of(const Scene& scene, const Lidar& lidar, const Pose& T_base_lidar, const Drive& drive,
                    int index) {
  const Stamp stamp{lidar.period.count() * index};
  return sweep(scene, lidar, T_base_lidar, stamp,
               [&](Duration offset) { return drive.at(to_seconds(Duration(stamp.ns) + offset)); });
}

/// True motion between scans index - 1 and index, its translation scaled by `scale` and its heading off by
/// `yaw_error`.
inline WheelDelta wheels_of(const Lidar& lidar, const Drive& drive, int index, double scale = 1.0,
                            double yaw_error = 0.0) {
  const double dt = to_seconds(lidar.period);
  Vector6 motion = (drive.at((index - 1) * dt).inverse() * drive.at(index * dt)).log();
  motion.head<3>() *= scale;
  motion[5] += yaw_error;
  WheelDelta delta;
  delta.duration = lidar.period;
  delta.T_base0_base1 = Pose::exp(motion);
  return delta;
}

/// 24 x 16 x 6 m with boxes: every direction is well fixed.
inline Scene furnished_room() {
  return {0.0,
          -std::numeric_limits<double>::infinity(),
          {{{-12.0, -8.0, -1.0}, {12.0, 8.0, 5.0}}},
          {{{4.0, 3.0, -1.0}, {6.0, 5.0, 2.0}},
           {{-7.0, -6.0, -1.0}, {-5.0, -3.0, 3.0}},
           {{2.0, -7.0, -1.0}, {3.0, -5.0, 1.0}}}};
}

/// Scan `index` of a robot that stands in the furnished room.
inline Scan still_scan(const Pose& T_base_lidar, int index) {
  Lidar lidar{32, 256, 0.35, 120.0, 0.01};
  lidar.jitter = 0.5;
  return scan_of(furnished_room(), lidar, T_base_lidar, {Pose::planar(-3, 0, 0.2), Vector6::Zero()}, index);
}

/// A smooth tube along x, 4 m in radius, with a floor 2 m below its axis, without end.
inline Scene smooth_tube() { return {4.0, -2.0, {}, {}}; }

}  // namespace adit::test

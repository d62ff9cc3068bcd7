// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/surface_path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "adit/core/angles.hpp"
#include "adit/core/parallel.hpp"
#include "adit/simulation/floor_line.hpp"

namespace adit {
namespace {

// Metres.
constexpr double kSampleStep = 1.0;
constexpr double kViewHeight = 0.9;    ///< Above the floor, below the roofs of low drifts.
constexpr double kFarthestWall = 6.0;  ///< At the side; beyond it opens into another tunnel.
constexpr double kRoomToWall = 0.3;    ///< From a viewpoint.
constexpr double kNoMotion = 1e-3;

constexpr std::size_t kSmoothing = 5;  ///< Samples to either side, over which the middle is a median.
constexpr std::array<double, kRings> kRingElevations{0.0, 40.0, -40.0};  ///< Degrees ahead.

std::array<Eigen::Vector3f, kRays> make_directions() {
  std::array<Eigen::Vector3f, kRays> directions;
  for (std::size_t ring = 0; ring < kRings; ++ring)
    for (std::size_t k = 0; k < kRaysPerRing; ++k) {
      const double ahead = kRingElevations[ring] * kDegree;
      const double around = 2.0 * std::numbers::pi * static_cast<double>(k) / kRaysPerRing;
      directions[ring * kRaysPerRing + k] =
          Vector3(std::sin(ahead), std::cos(ahead) * std::cos(around), std::cos(ahead) * std::sin(around))
              .cast<float>();
    }
  return directions;
}

/// Points of the path, `kSampleStep` apart along it.
std::vector<Vector3> evenly_along(const Trajectory& truth) {
  std::vector<Vector3> points;
  double driven = 0.0;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const Vector3& from = truth[i - 1].T_world_body.translation();
    const Vector3& to = truth[i].T_world_body.translation();
    const double length = (to - from).norm();
    for (double next = kSampleStep * static_cast<double>(points.size());
         length > 0.0 && next <= driven + length; next = kSampleStep * static_cast<double>(points.size()))
      points.push_back(from + (next - driven) / length * (to - from));
    driven += length;
  }
  return driven < kSampleStep ? std::vector<Vector3>{} : points;
}

/// Of the path around point i, in the horizontal plane.
double heading_at(const std::vector<Vector3>& points, std::size_t i) {
  constexpr std::size_t kAround = 2;
  const Vector3 chord = points[std::min(i + kAround, points.size() - 1)] - points[i - std::min(i, kAround)];
  return chord.head<2>().norm() < kNoMotion ? 0.0 : std::atan2(chord.y(), chord.x());
}

/// Metres of free room to the left and right, at most kFarthestWall.
std::array<double, 2> room_beside(const Raycaster& world, const Pose& T_world_view) {
  std::array<double, 2> room{};
  for (const double side : {1.0, -1.0}) {
    const Vector3 direction = T_world_view.rotation() * Vector3(0.0, side, 0.0);
    const RayHit hit = world.cast({T_world_view.translation().cast<float>(), direction.cast<float>()},
                                  static_cast<float>(kFarthestWall));
    room[side > 0.0 ? 0 : 1] = hit.hit() ? static_cast<double>(hit.distance) : kFarthestWall;
  }
  return room;
}

double median_around(const std::vector<double>& values, std::size_t i) {
  const std::size_t begin = i - std::min(i, kSmoothing);
  const std::size_t end = std::min(i + kSmoothing + 1, values.size());
  std::vector<double> around(values.begin() + static_cast<std::ptrdiff_t>(begin),
                             values.begin() + static_cast<std::ptrdiff_t>(end));
  const auto middle = around.begin() + static_cast<std::ptrdiff_t>(around.size() / 2);
  std::ranges::nth_element(around, middle);
  return *middle;
}

std::vector<Pose> views_along(const Raycaster& world, std::vector<Vector3> points) {
  std::vector<Pose> on_path;
  std::vector<std::array<double, 2>> room;
  std::vector<double> to_middle;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector3& p = points[i];
    const double floor = floor_height(world, p).value_or(p.z());
    on_path.push_back(Pose::planar(p.x(), p.y(), heading_at(points, i), floor + kViewHeight));
    room.push_back(room_beside(world, on_path.back()));
    to_middle.push_back(0.5 * (room.back()[0] - room.back()[1]));
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [left, right] = room[i];
    const double least = std::min(kRoomToWall - right, 0.0);
    const double most = std::max(left - kRoomToWall, 0.0);
    points[i] = on_path[i] * Vector3(0.0, std::clamp(median_around(to_middle, i), least, most), 0.0);
  }
  std::vector<Pose> views;
  for (std::size_t i = 0; i < points.size(); ++i)
    views.push_back(Pose::planar(points[i].x(), points[i].y(), heading_at(points, i), points[i].z()));
  return views;
}

SurfaceSample seen_from(const Raycaster& world, const Pose& T_world_view) {
  SurfaceSample sample{T_world_view, {}, {}};
  const Eigen::Vector3f origin = T_world_view.translation().cast<float>();
  const Eigen::Matrix3f R_world_view = T_world_view.rotation_matrix().cast<float>();
  for (std::size_t ray = 0; ray < kRays; ++ray) {
    const RayHit hit = world.cast({origin, R_world_view * ray_directions()[ray]}, kRayReach);
    sample.ranges[ray] = hit.hit() ? hit.distance : kRayReach;
    sample.normals[ray] = hit.hit() ? R_world_view.transpose() * hit.normal : Eigen::Vector3f(0, 0, 0);
  }
  return sample;
}

}  // namespace

const std::array<Eigen::Vector3f, kRays>& ray_directions() {
  static const std::array<Eigen::Vector3f, kRays> directions = make_directions();
  return directions;
}

std::size_t turned_ray(std::size_t ray) {
  const std::size_t ring = ray / kRaysPerRing;
  const std::size_t k = ray % kRaysPerRing;
  const std::size_t turned_ring = ring == 0 ? 0 : 3 - ring;
  return turned_ring * kRaysPerRing + (kRaysPerRing + kRaysPerRing / 2 - k) % kRaysPerRing;
}

std::vector<SurfaceSample> surface_along(const Raycaster& world, const Trajectory& truth) {
  const std::vector<Pose> views = views_along(world, evenly_along(truth));
  std::vector<SurfaceSample> samples(views.size());
  parallel_for_each(
      views.size(), [&](std::size_t i) { samples[i] = seen_from(world, views[i]); }, 16);
  return samples;
}

}  // namespace adit

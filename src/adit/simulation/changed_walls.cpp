// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/changed_walls.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

#include "adit/core/rng.hpp"
#include "adit/simulation/things.hpp"

namespace adit {
namespace {

constexpr double kStretchLength = 20.0;
constexpr double kFadeLength = 3.0;  ///< Of its length, at each end.
constexpr double kPathStep = 0.5;
constexpr double kFarthestWall = 12.0;  ///< Walls farther from the path stay.
constexpr double kFreeBeside = 1.2;     ///< Beside the path.

double smooth_step(double x) {
  const double t = std::clamp(x, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

struct Stretch {
  std::vector<Pose> poses;
  double inwards;  // metres, negative: widened
  int side;        // 1: left, -1: right, 0: all around
};

/// Unit normals towards free space. Vertices at one position have the same, so that no crack opens.
std::vector<Vector3> vertex_normals(const TriangleMesh& mesh) {
  const std::size_t num = mesh.vertices.size();
  std::vector<Vector3> sums(num, Vector3::Zero());
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto corner = [&](int i) -> Vector3 {
      return mesh.vertices[static_cast<std::size_t>(t[i])].cast<double>();
    };
    const Vector3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    for (int i = 0; i < 3; ++i) sums[static_cast<std::size_t>(t[i])] += normal;
  }
  const auto key = [&](std::size_t i) {
    const Eigen::Vector3f& p = mesh.vertices[i];
    return std::tuple(p.x(), p.y(), p.z());
  };
  std::vector<std::size_t> order(num);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(
      order, [&](std::size_t a, std::size_t b) { return std::pair(key(a), a) < std::pair(key(b), b); });
  for (std::size_t begin = 0; begin < num;) {
    std::size_t end = begin;
    Vector3 sum = Vector3::Zero();
    for (; end < num && key(order[end]) == key(order[begin]); ++end) sum += sums[order[end]];
    for (; begin < end; ++begin) sums[order[begin]] = sum.normalized();
  }
  return sums;
}

/// How far a vertex moves along its normal.
double change_at(const Stretch& stretch, const Vector3& vertex, const Vector3& normal) {
  const auto distance = [&](const Pose& pose) { return (pose.translation() - vertex).squaredNorm(); };
  const auto nearest = std::ranges::min_element(stretch.poses, {}, distance);
  const Vector3 p = nearest->inverse() * vertex;
  const double away = p.tail<2>().norm();
  const bool is_before_or_behind = std::abs(p.x()) > kPathStep;
  const bool faces_path = normal.dot(nearest->translation() + Vector3(0.0, 0.0, 1.0) - vertex) > 0.0;
  if (away > kFarthestWall || is_before_or_behind || !faces_path) return 0.0;
  const double at = kPathStep * static_cast<double>(nearest - stretch.poses.begin());
  const double end = kPathStep * static_cast<double>(stretch.poses.size() - 1) - at;
  const double along = smooth_step(std::min(at, end) / kFadeLength);
  const double above_floor = smooth_step((p.z() - 0.3) / 0.5);
  const double beside = stretch.side == 0 ? 1.0 : smooth_step(stretch.side * p.y());
  const double most_inwards = std::max(0.0, 0.5 * (std::abs(p.y()) - kFreeBeside));
  const bool is_roof = std::abs(normal.z()) > 0.7;
  const double inwards = is_roof ? std::min(stretch.inwards, 0.3) : std::min(stretch.inwards, most_inwards);
  return inwards * along * above_floor * beside;
}

void move_walls(const Stretch& stretch, const std::vector<Vector3>& normals, TriangleMesh& mesh) {
  Eigen::AlignedBox3d around;
  for (const Pose& pose : stretch.poses) around.extend(pose.translation());
  around.min().array() -= kFarthestWall;
  around.max().array() += kFarthestWall;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vector3 vertex = mesh.vertices[i].cast<double>();
    if (!around.contains(vertex)) continue;
    const double change = change_at(stretch, vertex, normals[i]);
    if (change != 0.0) mesh.vertices[i] = (vertex + change * normals[i]).cast<float>();
  }
}

Stretch draw_stretch(const std::vector<Pose>& poses, const ChangedWalls& changes, Rng& rng) {
  const auto num = std::min(poses.size(), static_cast<std::size_t>(kStretchLength / kPathStep) + 1);
  const auto begin = static_cast<std::ptrdiff_t>(rng.below(poses.size() - num + 1));
  const double size = changes.largest * rng.uniform(1.0 / 6.0, 1.0);
  const double inwards = rng.uniform() < 0.5 ? size : -size;
  const int side = static_cast<int>(rng.below(3)) - 1;
  return {{poses.begin() + begin, poses.begin() + begin + static_cast<std::ptrdiff_t>(num)}, inwards, side};
}

}  // namespace

TriangleMesh with_changed_walls(TriangleMesh world, const Trajectory& path, const ChangedWalls& changes,
                                std::uint64_t seed) {
  const std::vector<Pose> poses = poses_along(path, kPathStep);
  const double length = kPathStep * static_cast<double>(poses.size());
  Rng rng(seed);
  const std::uint64_t num = rng.poisson(length / 1000.0 * changes.per_km);
  if (num == 0) return world;
  const std::vector<Vector3> normals = vertex_normals(world);
  for (std::uint64_t i = 0; i < num; ++i) move_walls(draw_stretch(poses, changes, rng), normals, world);
  return world;
}

}  // namespace adit

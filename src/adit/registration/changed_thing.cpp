// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/changed_thing.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace adit {
namespace {

constexpr ThingShape kThing;
constexpr float kFloorNormal = 0.8F;  // least vertical part of its normal
constexpr float kWallNormal = 0.7F;   // largest vertical part of that of a wall

std::optional<float> floor_under(const SeenSurface& scan, const Eigen::AlignedBox3f& box) {
  const Eigen::AlignedBox2f there(box.min().head<2>(), box.max().head<2>());
  std::optional<float> lowest;
  std::optional<float> nearest;
  float nearest_m = std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < scan.points().size(); ++i) {
    const Eigen::Vector3f& p = scan.points().points[i];
    if (scan.points().normals[i].z() < kFloorNormal) continue;
    const float away = there.exteriorDistance(p.head<2>());
    if (away < nearest_m) {
      nearest_m = away;
      nearest = p.z();
    }
    if (away > static_cast<float>(kThing.floor_around_m)) continue;
    lowest = lowest ? std::min(*lowest, p.z()) : p.z();
  }
  return lowest ? lowest : nearest;
}

/// Points of a wall that goes on beside them as one that both scans saw.
bool continues_a_wall(const SeenSurface& scan, std::size_t point, const std::vector<Compared>& compared,
                      float voxel) {
  constexpr float kOffPlaneVoxels = 0.5F;
  constexpr float kSameWall = 0.9F;  // cosine between normals
  const Eigen::Vector3f& p = scan.points().points[point];
  const Eigen::Vector3f& normal = scan.points().normals[point];
  if (std::abs(normal.z()) > kWallNormal) return false;
  const Eigen::Vector3f along = normal.cross(Eigen::Vector3f::UnitZ()).normalized();
  return std::ranges::any_of(std::array{-3.0F, -2.0F, 2.0F, 3.0F}, [&](float voxels) {
    const auto near = scan.grid().nearest(p + voxels * voxel * along, voxel);
    return near && compared[near->index] == Compared::same_surface &&
           std::abs(normal.dot(scan.points().points[near->index] - p)) < kOffPlaneVoxels * voxel &&
           normal.dot(scan.points().normals[near->index]) > kSameWall;
  });
}

}  // namespace

Fields fields_of(ThingShape& c) {
  return {{"tallest_m", &c.tallest_m, "m", 0.0, 100.0,
           "what ends higher above the floor is no vehicle and counts as structure"},
          {"longest_m", &c.longest_m, "m", 0.0, 100.0, "what is longer in plan is none either"},
          {"highest_foot_m", &c.highest_foot_m, "m", 0.0, 100.0,
           "what begins higher above the floor hangs there: what is lower may be hidden"},
          {"floor_around_m", &c.floor_around_m, "m", 0.0, 100.0,
           "distance from a thing to the floor that it stands on, in plan, at most"}};
}

std::vector<std::vector<std::size_t>> connected_patches(const std::vector<Eigen::Vector3f>& points,
                                                        float cell_size) {
  using Cell = std::array<int, 3>;
  std::map<Cell, std::vector<std::size_t>> cells;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f scaled = points[i] / cell_size;
    cells[{static_cast<int>(std::floor(scaled.x())), static_cast<int>(std::floor(scaled.y())),
           static_cast<int>(std::floor(scaled.z()))}]
        .push_back(i);
  }
  std::vector<std::vector<std::size_t>> patches;
  std::vector<Cell> reached;
  while (!cells.empty()) {
    std::vector<std::size_t>& patch = patches.emplace_back();
    const auto take = [&](std::map<Cell, std::vector<std::size_t>>::iterator cell) {
      patch.insert(patch.end(), cell->second.begin(), cell->second.end());
      reached.push_back(cell->first);
      cells.erase(cell);
    };
    take(cells.begin());
    while (!reached.empty()) {
      const Cell at = reached.back();
      reached.pop_back();
      for (int neighbour = 0; neighbour < 27; ++neighbour) {
        const Cell next = {at[0] + neighbour % 3 - 1, at[1] + neighbour / 3 % 3 - 1,
                           at[2] + neighbour / 9 - 1};
        if (const auto cell = cells.find(next); cell != cells.end()) take(cell);
      }
    }
  }
  std::ranges::stable_sort(patches, std::ranges::greater(), &std::vector<std::size_t>::size);
  return patches;
}

bool may_be_a_thing(const SeenSurface& scan, std::span<const std::size_t> patch,
                    const std::vector<Compared>& compared, const RegistrationConfig& config) {
  Eigen::AlignedBox3f box;
  for (const std::size_t i : patch) box.extend(scan.points().points[i]);
  if (box.isEmpty() || box.sizes().head<2>().norm() > static_cast<float>(kThing.longest_m)) return false;
  const std::optional<float> floor = floor_under(scan, box);
  if (!floor || box.min().z() > *floor + static_cast<float>(kThing.highest_foot_m) ||
      box.max().z() > *floor + static_cast<float>(kThing.tallest_m))
    return false;
  const auto num_continuing = std::ranges::count_if(patch, [&](std::size_t i) {
    return continues_a_wall(scan, i, compared, static_cast<float>(config.voxel_size));
  });
  // What fills an opening meets walls on both sides: more points than the patch has along one of its edges.
  return static_cast<double>(num_continuing) < 2.0 * std::sqrt(static_cast<double>(patch.size()));
}

}  // namespace adit

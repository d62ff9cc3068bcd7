// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/sync/own_map_parts.hpp"

#include <algorithm>
#include <utility>

#include "adit/fleet/sync/parts.hpp"
#include "adit/geometry/voxel_grid.hpp"

namespace adit {
namespace {

std::vector<VoxelKey> keys_of(const std::vector<Eigen::Vector3f>& points, double voxel_m) {
  std::vector<VoxelKey> keys(points.size());
  VoxelGrid(voxel_m).keys_of(points, keys);
  return keys;
}

/// Those of `points` that lie in voxels where none of `taken` does.
std::vector<Eigen::Vector3f> in_other_voxels(const std::vector<Eigen::Vector3f>& points,
                                             const std::vector<Eigen::Vector3f>& taken, double voxel_m) {
  std::vector<VoxelKey> full = keys_of(taken, voxel_m);
  std::ranges::sort(full);
  const std::vector<VoxelKey> keys = keys_of(points, voxel_m);
  std::vector<Eigen::Vector3f> others;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!std::ranges::binary_search(full, keys[i])) others.push_back(points[i]);
  return others;
}

}  // namespace

std::vector<std::uint32_t> searchable_keyframes(const RobotMap& map) {
  std::vector<std::uint32_t> indices;
  for (std::uint32_t k = 0; k < map.keyframes.size(); ++k) {
    if (map.searchable[k]) indices.push_back(k);
  }
  return indices;
}

std::vector<MessageBody> places_since(const RobotMap& map, std::size_t first) {
  const std::vector<std::uint32_t> indices = searchable_keyframes(map);
  std::vector<MessageBody> out;
  for_parts(indices, first, kPlacesPerMessage,
            [&](std::uint32_t begin, const std::vector<std::uint32_t>& part) {
              Places places;
              places.first = begin;
              for (const std::uint32_t k : part) places.places.push_back({k, map.places[k]});
              places.last = begin + part.size() == indices.size();
              out.emplace_back(std::move(places));
            });
  return out;
}

Clouds clouds_of(const RobotMap& map, const CloudRequest& request, const SentClouds& config) {
  Clouds clouds;
  clouds.kind = request.kind;
  for (const std::uint32_t index : request.indices) {
    if (index >= map.keyframes.size()) continue;
    // The receiver thins clouds to the same voxels: more points would change nothing.
    const auto thinned = [&](const SubmapConfig& of) {
      return voxel_centroids(submap(map, index, of), config.voxel_m).points;
    };
    Clouds::Cloud cloud{index, map.viewpoint.cast<float>(), {}};
    cloud.unconfirmed = map.unconfirmed[index];
    if (request.kind == CloudKind::submap) {
      cloud.points = thinned(config.submap);
    } else {
      PointCloud scan = voxel_centroids(*map.keyframes[index].cloud, config.voxel_m);
      cloud.points = std::move(scan.points);
      cloud.intensities = std::move(scan.intensities);
      cloud.beside = in_other_voxels(thinned(config.view), cloud.points, config.voxel_m);
    }
    clouds.clouds.push_back(std::move(cloud));
  }
  return clouds;
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/sync/own_map_parts.hpp"

#include "adit/fleet/sync/parts.hpp"
#include "adit/geometry/voxel_grid.hpp"

namespace adit {

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
    const PointCloud thinned = request.kind == CloudKind::submap
                                   ? voxel_centroids(submap(map, index, config.submap), config.voxel_m)
                                   : voxel_centroids(*map.keyframes[index].cloud, config.voxel_m);
    clouds.clouds.push_back({index, map.viewpoint.cast<float>(), thinned.points});
  }
  return clouds;
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/features.hpp"

#include "adit/geometry/normals.hpp"
#include "adit/geometry/radius_search.hpp"
#include "adit/geometry/voxel_grid.hpp"
#include "adit/registration/fpfh.hpp"

namespace adit {

namespace {

/// The mean point of each voxel, in the order of larger cells, so that neighbours in space are neighbours in
/// memory.
struct VoxelMeans {
  VoxelMeans(const PointCloud& cloud, double voxel_size, float cell_size) {
    const PointCloud centroids = voxel_centroids(cloud, voxel_size);
    const std::vector<std::uint32_t> order = order_by_cell(centroids.points, cell_size);
    points.resize(order.size());
    intensities.resize(centroids.intensities.size());
    positions.resize(order.size());
    for (std::uint32_t k = 0; k < order.size(); ++k) {
      points[k] = centroids.points[order[k]];
      if (!intensities.empty()) intensities[k] = centroids.intensities[order[k]];
      positions[order[k]] = k;
    }
  }
  std::vector<Eigen::Vector3f> points;
  std::vector<float> intensities;  ///< Of the points; empty where the cloud has none.
  std::vector<std::uint32_t>
      positions;  ///< In `points`, of the voxels in the order in which they first occur.
};

}  // namespace

/// Faster PFH (Lim et al., section III-B): one neighbour search serves the normals and the histograms.
Features compute_features(const PointCloud& cloud, const RegistrationConfig& config) {
  const auto voxel = static_cast<float>(config.voxel_size);
  const float feature_radius = voxel * static_cast<float>(config.feature_radius_voxels);
  const float normal_radius = voxel * static_cast<float>(config.normal_radius_voxels);
  const VoxelMeans means(cloud, config.voxel_size, feature_radius);
  const NeighborPairs pairs = find_pairs_within(means.points, feature_radius);
  std::vector<SurfacePoint> surface = estimate_surface(means.points, pairs, normal_radius);
  for (SurfacePoint& s : surface)
    s.valid = s.valid && s.linearity <= static_cast<float>(config.max_linearity);
  const FpfhResult fpfh = compute_fpfh(means.points, surface, pairs);
  Features features;
  for (const std::uint32_t k : means.positions) {
    if (!fpfh.usable[k]) continue;
    features.points.push_back(means.points[k]);
    features.normals.push_back(surface[k].normal);
    features.descriptors.push_back(fpfh.descriptors[k]);
  }
  return features;
}

OrientedPoints compute_surface(const PointCloud& cloud, const RegistrationConfig& config) {
  const auto radius = static_cast<float>(config.voxel_size * config.normal_radius_voxels);
  const VoxelMeans means(cloud, config.voxel_size, radius);
  const NeighborPairs pairs = find_pairs_within(means.points, radius);
  const std::vector<SurfacePoint> surface = estimate_surface(means.points, pairs, radius);
  OrientedPoints out;
  for (const std::uint32_t k : means.positions) {
    if (!surface[k].valid) continue;
    out.points.push_back(means.points[k]);
    out.normals.push_back(surface[k].normal);
    if (!means.intensities.empty()) out.intensities.push_back(means.intensities[k]);
  }
  return out;
}

}  // namespace adit

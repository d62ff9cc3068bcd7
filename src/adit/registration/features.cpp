// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/features.hpp"

#include "adit/geometry/normals.hpp"
#include "adit/geometry/radius_search.hpp"
#include "adit/geometry/voxel_grid.hpp"
#include "adit/registration/fpfh.hpp"

namespace adit {

/// Faster PFH (Lim et al., section III-B): one neighbour search serves the normals and the histograms.
Features compute_features(const PointCloud& cloud, const RegistrationConfig& config) {
  const auto voxel = static_cast<float>(config.voxel_size);
  const float feature_radius = voxel * static_cast<float>(config.feature_radius_voxels);
  const float normal_radius = voxel * static_cast<float>(config.normal_radius_voxels);
  const std::vector<Eigen::Vector3f> points = voxel_centroids(cloud, config.voxel_size).points;
  const NeighborPairs pairs = find_pairs_within(points, feature_radius);
  std::vector<SurfacePoint> surface = estimate_surface(points, pairs, normal_radius);
  for (SurfacePoint& s : surface)
    s.valid = s.valid && s.linearity <= static_cast<float>(config.max_linearity);
  const FpfhResult fpfh = compute_fpfh(points, surface, pairs);
  Features features;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!fpfh.usable[i]) continue;
    features.points.push_back(points[i]);
    features.normals.push_back(surface[i].normal);
    features.descriptors.push_back(fpfh.descriptors[i]);
  }
  return features;
}

}  // namespace adit

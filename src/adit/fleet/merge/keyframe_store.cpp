// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/keyframe_store.hpp"

namespace adit {
namespace {

std::size_t bytes_of(const Features& features) {
  return features.points.capacity() * sizeof(Eigen::Vector3f) +
         features.normals.capacity() * sizeof(Eigen::Vector3f) +
         features.descriptors.capacity() * sizeof(Descriptor);
}

}  // namespace

FeatureStore::FeatureStore(std::shared_ptr<const RobotMap> map, const RegistrationConfig& config,
                           const SubmapConfig& submap_config, std::size_t max_bytes)
    : KeyframeStore(
          std::move(map),
          [config, submap_config](const RobotMap& of, std::uint32_t k) {
            return compute_features(submap(of, k, submap_config), config);
          },
          bytes_of, max_bytes) {}

SeenPlace::SeenPlace(const PointCloud& of_view, const PointCloud& of_scan, const Vector3& viewpoint,
                     const RegistrationConfig& config)
    : view(compute_surface(of_view, config), viewpoint, config.voxel_size),
      scan(compute_surface(of_scan, config), viewpoint, config.voxel_size) {}

SurfaceStore::SurfaceStore(std::shared_ptr<const RobotMap> map, const RegistrationConfig& config,
                           const SubmapConfig& view_config, std::size_t max_bytes)
    : KeyframeStore(
          std::move(map),
          [config, view_config](const RobotMap& of, std::uint32_t k) {
            return SeenPlace(submap(of, k, view_config), *of.keyframes[k].cloud, of.viewpoint, config);
          },
          [](const SeenPlace& place) { return place.num_bytes(); }, max_bytes) {}

}  // namespace adit

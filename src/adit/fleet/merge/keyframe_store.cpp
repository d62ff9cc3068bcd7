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

SeenSurface view_of(const PointCloud& scan_and_beside, const Vector3& viewpoint,
                    const RegistrationConfig& config) {
  return {compute_surface(scan_and_beside, config), viewpoint, config.voxel_size};
}

SearchableSurface scan_of(const PointCloud& scan, const Vector3& viewpoint,
                          const RegistrationConfig& config) {
  return {compute_surface(scan, config), viewpoint, config.voxel_size};
}

ViewStore::ViewStore(std::shared_ptr<const RobotMap> map, const RegistrationConfig& config,
                     const SubmapConfig& view_config, std::size_t max_bytes)
    : KeyframeStore(
          std::move(map),
          [config, view_config](const RobotMap& of, std::uint32_t k) {
            return view_of(submap(of, k, view_config), of.viewpoint, config);
          },
          [](const SeenSurface& view) { return view.num_bytes(); }, max_bytes) {}

ScanStore::ScanStore(std::shared_ptr<const RobotMap> map, const RegistrationConfig& config,
                     std::size_t max_bytes)
    : KeyframeStore(
          std::move(map),
          [config](const RobotMap& of, std::uint32_t k) {
            return scan_of(*of.keyframes[k].cloud, of.viewpoint, config);
          },
          [](const SearchableSurface& scan) { return scan.num_bytes(); }, max_bytes) {}

}  // namespace adit

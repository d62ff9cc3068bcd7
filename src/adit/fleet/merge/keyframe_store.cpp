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

SurfaceStore::SurfaceStore(std::shared_ptr<const RobotMap> map, const RegistrationConfig& config,
                           std::size_t max_bytes)
    : KeyframeStore(
          std::move(map),
          [config](const RobotMap& of, std::uint32_t k) {
            return SeenSurface(compute_surface(*of.keyframes[k].cloud, config), of.viewpoint,
                               config.voxel_size);
          },
          [](const SeenSurface& surface) { return surface.num_bytes(); }, max_bytes) {}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "adit/geometry/voxel_grid.hpp"

namespace adit {

/// The sparse map that scans are registered to: at most `max_points_per_voxel` points a voxel, none nearer to
/// another of its voxel than voxel_size / sqrt(max_points_per_voxel) (KISS-ICP, section III-B). Points lie in
/// one flat float array, a block a voxel, x, y and z apart from each other, so that a whole block is compared
/// at a time.
class LocalMap {
 public:
  struct Neighbour {
    Eigen::Vector3f point;
    float squared_distance = 0.0F;
  };

  /// `voxel_size` and `max_points_per_voxel` positive.
  LocalMap(double voxel_size, int max_points_per_voxel);

  [[nodiscard]] double voxel_size() const { return static_cast<double>(grid_.voxel_size()); }
  [[nodiscard]] bool empty() const { return table_.size() == 0; }
  [[nodiscard]] std::size_t num_voxels() const { return table_.size(); }
  [[nodiscard]] std::size_t num_points() const;
  [[nodiscard]] std::vector<Eigen::Vector3f> points() const;

  /// Adds those points that their voxels still have room for. Points that are not finite are left
  /// out.
  void add(std::span<const Eigen::Vector3f> points_base, const Pose& T_map_base);
  /// Removes each voxel whose first point is farther than `max_distance` from `centre`.
  void remove_beyond(const Eigen::Vector3f& centre, double max_distance);

  /// The nearest point strictly nearer than `max_distance`, of the 27 voxels around the query.
  [[nodiscard]] std::optional<Neighbour> nearest(const Eigen::Vector3f& query, float max_distance) const;
  /// Calls `visit(point)` for each point within `radius` (at most one voxel) of `centre`.
  template <class Visit>
  void for_each_within(const Eigen::Vector3f& centre, float radius, const Visit& visit) const;

 private:
  struct Voxel {
    VoxelKey key;
    std::uint32_t num_points = 0;  ///< 0 marks a block that is free for the next new voxel.
  };

  [[nodiscard]] const float* block(std::size_t voxel) const {
    return coordinates_.data() + voxel * 3 * stride_;
  }
  [[nodiscard]] float* block(std::size_t voxel) { return coordinates_.data() + voxel * 3 * stride_; }
  [[nodiscard]] std::uint32_t voxel_for(VoxelKey key);
  void add_point(const Eigen::Vector3f& point);

  VoxelGrid grid_;
  std::uint32_t max_points_per_voxel_;
  float min_squared_spacing_;
  std::size_t
      stride_;  ///< Floats a coordinate and block: max_points_per_voxel rounded up to whole vectors of four.
  VoxelTable table_;
  std::vector<Voxel> voxels_;
  std::vector<float> coordinates_;  ///< Unused places hold infinity: never near anything.
  std::vector<std::uint32_t> free_;
};

template <class Visit>
void LocalMap::for_each_within(const Eigen::Vector3f& centre, float radius, const Visit& visit) const {
  const auto key = grid_.key_of(centre);
  if (!key) return;
  for (int i = 0; i < 27; ++i) {
    const auto voxel = table_.find(key->shifted(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
    if (!voxel) continue;
    const float* x = block(*voxel);
    for (std::size_t k = 0; k < voxels_[*voxel].num_points; ++k) {
      const Eigen::Vector3f p(x[k], x[stride_ + k], x[2 * stride_ + k]);
      if ((p - centre).squaredNorm() < radius * radius) visit(p);
    }
  }
}

}  // namespace adit

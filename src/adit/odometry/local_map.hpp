// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/geometry/voxel_grid.hpp"

namespace adit {

/// The sparse map that scans are registered to: at most `max_points_per_voxel` points a voxel, none nearer to
/// another of its voxel than voxel_size / sqrt(max_points_per_voxel) (KISS-ICP, section III-B). Points lie in
/// one flat float array, a block a voxel, in groups of four, so that four are compared at a time.
class LocalMap {
 public:
  struct Neighbour {
    Eigen::Vector3f point;
    float squared_distance = 0.0F;
  };

  /// The answer of `search`, and how long it stands: `nearest` stays the answer for a query that has moved by
  /// m < room, as long as its distance (or the greatest that counts, if there is none) is below clearance -
  /// m.
  struct Found {
    std::optional<Neighbour> nearest;
    float clearance = 0.0F;  ///< Metres: all other points that the search is about are at least so far.
    float room = 0.0F;       ///< Metres: so far the query may move until the search is about other points.
  };

  /// The points around a place: how many, and the sums of their offsets d from it and of d d^T.
  struct Moments {
    int count = 0;
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();
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

  /// The nearest point strictly nearer than `max_distance`, of the 27 voxels around the query; voxels within
  /// `margin` of it are looked at as well, so that the clearance says more.
  [[nodiscard]] Found search(const Eigen::Vector3f& query, float max_distance, float margin) const;
  [[nodiscard]] std::optional<Neighbour> nearest(const Eigen::Vector3f& query, float max_distance) const {
    return search(query, max_distance, 0.0F).nearest;
  }
  /// Of the points nearer than `radius` (at most one voxel) to `centre`.
  [[nodiscard]] Moments moments_within(const Eigen::Vector3f& centre, float radius) const;

 private:
  [[nodiscard]] const float* block(std::size_t voxel) const {
    return coordinates_.data() + voxel * block_size_;
  }
  [[nodiscard]] float* block(std::size_t voxel) { return coordinates_.data() + voxel * block_size_; }
  [[nodiscard]] std::uint32_t voxel_for(VoxelKey key);
  void add_point(const Eigen::Vector3f& point, std::uint32_t voxel);

  VoxelGrid grid_;
  std::uint32_t max_points_per_voxel_;
  float min_squared_spacing_;
  std::size_t block_size_;  ///< Floats a voxel.
  VoxelTable table_;
  std::vector<VoxelKey> keys_;             ///< Of each block.
  std::vector<std::uint32_t> num_points_;  ///< Of each block; 0 where it is free for the next new voxel.
  std::vector<Eigen::Vector3f> first_;     ///< First point of each block; NaN where it is free.
  std::vector<float> coordinates_;         ///< Unused places hold infinity: never near anything.
  std::vector<std::uint32_t> free_;
  std::vector<Eigen::Vector3f> new_points_;  ///< Of the scan that is being added,
  std::vector<VoxelKey> new_keys_;           ///< their voxels,
  std::vector<std::uint32_t> new_voxels_;    ///< and the blocks of these.
};

}  // namespace adit

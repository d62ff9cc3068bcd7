// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/geometry/voxel_bricks.hpp"

namespace adit {

/// The sparse map that scans are registered to: at most `max_points_per_voxel` points per voxel, none nearer
/// to another of its voxel than voxel_size / sqrt(max_points_per_voxel) (KISS-ICP, section III-B). Points lie
/// in one flat float array, one block per voxel, in groups of four that are compared at once. Metres, map
/// frame.
class LocalMap {
 public:
  /// The answer of `nearest`.
  struct Neighbour {
    Eigen::Vector3f point;          ///< Map frame.
    float squared_distance = 0.0F;  ///< From the query, square metres.
  };

  /// Points near a query, and how long they suffice to know the nearest: for a query that has moved by m <
  /// room, the nearest is among them or farther than clearance - m.
  struct Candidates {
    static constexpr std::size_t kNumber = 8;     ///< Points that a search keeps.
    static constexpr float kNowhere = 1e9F;       ///< Coordinates of points that stand for none.
    std::array<Eigen::Vector3f, kNumber> points;  ///< In no order; those that are missing lie at kNowhere.
    float clearance = 0.0F;  ///< Metres: all other points that the search is about are at least so far.
    float room = 0.0F;       ///< Metres: so far the query may move until the search is about other points.
  };

  /// The points around a centre: their number, and the sums of their offsets d from it and of d d^T.
  struct Moments {
    int count = 0;                                      ///< Points.
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();      ///< Of d, metres.
    Eigen::Matrix3f squares = Eigen::Matrix3f::Zero();  ///< Of d d^T, square metres.
  };

  /// `voxel_size` and `max_points_per_voxel` positive.
  LocalMap(double voxel_size, int max_points_per_voxel);

  /// Edge of a voxel, metres.
  [[nodiscard]] double voxel_size() const { return static_cast<double>(grid_.voxel_size()); }
  /// Whether no voxel holds a point.
  [[nodiscard]] bool empty() const { return num_voxels() == 0; }
  /// Voxels that hold a point.
  [[nodiscard]] std::size_t num_voxels() const { return first_.size() - free_.size(); }
  /// All points, voxel by voxel; both take time in proportion to the map.
  ///@{
  [[nodiscard]] std::size_t num_points() const;
  [[nodiscard]] std::vector<Eigen::Vector3f> points() const;
  ///@}

  /// Adds those points that their voxels still have room for. Points that are not finite are left
  /// out.
  void add(std::span<const Eigen::Vector3f> points_base, const Pose& T_map_base);
  /// Removes each voxel whose first point is farther than `max_distance` from `centre`.
  void remove_beyond(const Eigen::Vector3f& centre, double max_distance);

  /// The nearest point strictly nearer than `max_distance`, of the 27 voxels around the query.
  [[nodiscard]] std::optional<Neighbour> nearest(const Eigen::Vector3f& query, float max_distance) const;
  /// The same point and others; with more `margin`, metres, they suffice for longer.
  [[nodiscard]] Candidates search(const Eigen::Vector3f& query, float max_distance, float margin) const;
  /// Of the points nearer than `radius` (at most one voxel) to `centre`.
  [[nodiscard]] Moments moments_within(const Eigen::Vector3f& centre, float radius) const;

 private:
  // What `voxels_` holds for a voxel with points: the number of its block, and how many points it has.
  static constexpr std::uint32_t kCountBits = 8;
  [[nodiscard]] static std::uint32_t block_of(std::uint32_t voxel) { return voxel >> kCountBits; }
  [[nodiscard]] static std::uint32_t count_of(std::uint32_t voxel) {
    return voxel & ((1U << kCountBits) - 1U);
  }

  [[nodiscard]] const float* block(std::size_t number) const { return &coordinates_[number * block_size_]; }
  [[nodiscard]] float* block(std::size_t number) { return &coordinates_[number * block_size_]; }
  [[nodiscard]] std::uint32_t new_block(VoxelKey key, const Eigen::Vector3f& first);
  void add_point(const Eigen::Vector3f& point, VoxelKey key, std::uint32_t& voxel);

  VoxelGrid grid_;
  std::uint32_t max_points_per_voxel_;
  float min_squared_spacing_;
  std::size_t block_size_;  ///< Floats per voxel.
  VoxelBricks voxels_;
  std::vector<VoxelKey> keys_;               ///< Of each block.
  std::vector<Eigen::Vector3f> first_;       ///< First point of each block; NaN where it is free.
  std::vector<float> coordinates_;           ///< Unused places hold infinity: never near anything.
  std::vector<std::uint32_t> free_;          ///< Blocks for the next new voxels.
  std::vector<Eigen::Vector3f> new_points_;  ///< Of the scan that is being added,
  std::vector<VoxelKey> new_keys_;           ///< their voxels,
  std::vector<std::uint32_t> new_places_;    ///< and where these lie in `voxels_`.
};

}  // namespace adit

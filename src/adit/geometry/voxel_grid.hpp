// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Space cut into cubes: keys of voxels, a flat hash table from key to number, and thinning of clouds.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "adit/core/check.hpp"
#include "adit/core/point_cloud.hpp"

namespace adit {

/// The three indices of a voxel (floor of coordinate / edge) in one word, 21 bits each, so that the key of a
/// neighbour is a sum. Indices reach from -2^20 to 2^20 - 1: 100 km in each direction at an edge of 0.1 m.
struct VoxelKey {
  std::uint64_t value = 0;  ///< x in the lowest bits, then y, then z; each with 2^20 added.

  auto operator<=>(const VoxelKey&) const = default;
  /// The key of three indices, which must be within the range above.
  [[nodiscard]] static VoxelKey of(int x, int y, int z) {
    return {biased(x) | (biased(y) << 21U) | (biased(z) << 42U)};
  }
  /// The voxel (dx, dy, dz) further on; exact while the sum stays within the index range.
  [[nodiscard]] VoxelKey shifted(int dx, int dy, int dz) const {
    return {value +
            static_cast<std::uint64_t>(dx + dy * (std::int64_t{1} << 21) + dz * (std::int64_t{1} << 42))};
  }
  /// No voxel's key: bit 63 is never set in one.
  [[nodiscard]] static constexpr VoxelKey none() { return {~std::uint64_t{0}}; }
  /// Fibonacci hashing: multiplication by 2^64 / golden ratio; the upper bits count.
  [[nodiscard]] std::uint64_t hash() const { return value * 0x9e3779b97f4a7c15ULL; }
  /// The three numbers that `of` was given.
  [[nodiscard]] Eigen::Vector3i indices() const {
    return {unbiased(value), unbiased(value >> 21U), unbiased(value >> 42U)};
  }

 private:
  static constexpr std::int64_t kBias = std::int64_t{1} << 20;
  static std::uint64_t biased(int i) { return static_cast<std::uint64_t>(i + kBias) & 0x1fffffU; }
  static int unbiased(std::uint64_t bits) {
    return static_cast<int>(static_cast<std::int64_t>(bits & 0x1fffffU) - kBias);
  }
};

/// Cubes of equal edge with one corner at the origin.
class VoxelGrid {
 public:
  /// `voxel_size` in metres, positive.
  explicit VoxelGrid(double voxel_size) : size_(static_cast<float>(voxel_size)), inverse_(1.0F / size_) {
    ADIT_CHECK(voxel_size > 0.0 && std::isfinite(voxel_size), "a voxel has a positive edge");
  }

  /// The edge, metres, as a float.
  [[nodiscard]] float voxel_size() const { return size_; }
  /// Nothing for NaN, infinity and points beyond the index range of VoxelKey.
  [[nodiscard]] std::optional<VoxelKey> key_of(const Eigen::Vector3f& p) const {
    const Eigen::Vector3f cell = p * inverse_;
    if (!(std::abs(cell.x()) < kLimit && std::abs(cell.y()) < kLimit && std::abs(cell.z()) < kLimit))
      return {};
    return VoxelKey::of(static_cast<int>(std::floor(cell.x())), static_cast<int>(std::floor(cell.y())),
                        static_cast<int>(std::floor(cell.z())));
  }
  /// The keys of many points, VoxelKey::none() for those that have none. `keys` is as long as `points`.
  void keys_of(std::span<const Eigen::Vector3f> points, std::span<VoxelKey> keys) const;

 private:
  static constexpr float kLimit = 1048575.0F;
  float size_;
  float inverse_;
};

/// From voxel key to a number chosen by the owner: open addressing with linear probing in one flat array, at
/// most half full. The table is never iterated, so its layout cannot leak into results.
class VoxelTable {
 public:
  /// Room for `expected` voxels before the first growth.
  explicit VoxelTable(std::size_t expected = 16);

  /// How many voxels have a number.
  [[nodiscard]] std::size_t size() const { return size_; }
  /// The voxel's number, if it has one.
  [[nodiscard]] std::optional<std::uint32_t> find(VoxelKey key) const {
    const Slot& slot = slots_[position_of(key)];
    if (slot.key == VoxelKey::none()) return {};
    return slot.number;
  }
  /// Prefetches the slot of `key` for a query that comes soon.
  void prefetch(VoxelKey key) const { __builtin_prefetch(&slots_[home_of(key)]); }
  /// The number that `key` already has; if it has none, it gets `number` and the answer is empty.
  std::optional<std::uint32_t> find_or_insert(VoxelKey key, std::uint32_t number) {
    Slot& slot = slots_[position_of(key)];
    if (slot.key == key) return slot.number;
    slot = {key, number};
    if (2 * ++size_ > slots_.size()) grow();
    return {};
  }
  /// False when there is no such key.
  bool erase(VoxelKey key);

 private:
  struct Slot {
    VoxelKey key = VoxelKey::none();
    std::uint32_t number = 0;
  };

  [[nodiscard]] std::size_t home_of(VoxelKey key) const {
    return static_cast<std::size_t>(key.hash() >> shift_);
  }
  // Where `key` is, or the empty slot where it would go.
  [[nodiscard]] std::size_t position_of(VoxelKey key) const {
    std::size_t i = home_of(key);
    while (slots_[i].key != key && slots_[i].key != VoxelKey::none()) i = (i + 1) & (slots_.size() - 1);
    return i;
  }
  void grow();

  std::vector<Slot> slots_;  ///< Their number is a power of two.
  unsigned shift_ = 0;
  std::size_t size_ = 0;
};

/// A set of voxels, stored as in VoxelTable.
class VoxelSet {
 public:
  /// Room for `expected` voxels before the first growth.
  explicit VoxelSet(std::size_t expected = 16);

  void clear();  ///< Keeps the room.
  /// False when `key` was there already.
  bool insert(VoxelKey key) {
    VoxelKey& slot = slots_[position_of(key)];
    if (slot == key) return false;
    slot = key;
    if (2 * ++size_ > slots_.size()) grow();
    return true;
  }

 private:
  [[nodiscard]] std::size_t position_of(VoxelKey key) const {
    std::size_t i = key.hash() >> shift_;
    while (slots_[i] != key && slots_[i] != VoxelKey::none()) i = (i + 1) & (slots_.size() - 1);
    return i;
  }
  void grow();

  std::vector<VoxelKey> slots_;  ///< Their number is a power of two.
  unsigned shift_ = 0;
  std::size_t size_ = 0;
};

/// Finds the first point of each voxel, and keeps its memory for the next cloud.
class VoxelThinner {
 public:
  /// Positions in `points`, ascending; points without a voxel are left out. The answer stands until the next
  /// call.
  std::span<const std::uint32_t> first_in_voxel(std::span<const Eigen::Vector3f> points, double voxel_size);

 private:
  struct Candidate {
    VoxelKey key;
    std::uint32_t index = 0;
  };
  static std::size_t find_candidates(const VoxelGrid& grid, std::span<const Eigen::Vector3f> points,
                                     std::uint32_t first_index, Candidate* candidates);

  std::vector<Candidate> candidates_;  ///< Each part of the cloud has its own range, filled from its front.
  std::vector<std::size_t> num_candidates_;  ///< Per part.
  VoxelSet seen_;
  std::vector<std::uint32_t> first_;
};

/// The first point of each voxel, in the order of the cloud, with its intensity and time. NaN points are
/// dropped.
[[nodiscard]] PointCloud voxel_downsample(const PointCloud& cloud, double voxel_size);

/// The same for bare points.
[[nodiscard]] std::vector<Eigen::Vector3f> voxel_downsample(std::span<const Eigen::Vector3f> points,
                                                            double voxel_size);

/// The mean point (intensity, time) of each voxel, in the order in which voxels first occur. NaN points are
/// dropped.
[[nodiscard]] PointCloud voxel_centroids(const PointCloud& cloud, double voxel_size);

}  // namespace adit

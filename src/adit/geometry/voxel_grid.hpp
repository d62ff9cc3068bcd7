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

/// A voxel's three indices (floor of coordinate / edge) in one word, 21 bits each, so that the key of a
/// neighbour is a sum. Indices reach from -2^20 to 2^20 - 1: 100 km either way at an edge of 0.1 m.
struct VoxelKey {
  std::uint64_t value = 0;

  auto operator<=>(const VoxelKey&) const = default;
  [[nodiscard]] static VoxelKey of(int x, int y, int z) {
    return {biased(x) | (biased(y) << 21U) | (biased(z) << 42U)};
  }
  /// The voxel (dx, dy, dz) further on; exact while the sum stays within the index range.
  [[nodiscard]] VoxelKey shifted(int dx, int dy, int dz) const {
    return {value +
            static_cast<std::uint64_t>(dx + dy * (std::int64_t{1} << 21) + dz * (std::int64_t{1} << 42))};
  }
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

  [[nodiscard]] float voxel_size() const { return size_; }
  /// Nothing for NaN, infinity and points beyond the index range of VoxelKey.
  [[nodiscard]] std::optional<VoxelKey> key_of(const Eigen::Vector3f& p) const {
    const Eigen::Vector3f cell = p * inverse_;
    constexpr float kLimit = 1048575.0F;
    if (!(std::abs(cell.x()) < kLimit && std::abs(cell.y()) < kLimit && std::abs(cell.z()) < kLimit))
      return {};
    return VoxelKey::of(static_cast<int>(std::floor(cell.x())), static_cast<int>(std::floor(cell.y())),
                        static_cast<int>(std::floor(cell.z())));
  }

 private:
  float size_;
  float inverse_;
};

/// From voxel key to a number chosen by the owner: open addressing with linear probing in one flat array, at
/// most half full. The table is never iterated, so its layout cannot leak into results.
class VoxelTable {
 public:
  /// Room for `expected` voxels before the first growth.
  explicit VoxelTable(std::size_t expected = 16);

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] std::optional<std::uint32_t> find(VoxelKey key) const {
    const Slot& slot = slots_[position_of(key)];
    if (slot.key == kEmpty) return {};
    return slot.number;
  }
  /// The number that `key` already has; otherwise gives it `number`, and the answer says nothing.
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
  static constexpr VoxelKey kEmpty{~std::uint64_t{0}};  // bit 63 is never set in a key
  struct Slot {
    VoxelKey key = kEmpty;
    std::uint32_t number = 0;
  };

  // Fibonacci hashing: the top bits of a multiplication by 2^64 / golden ratio.
  [[nodiscard]] std::size_t home_of(VoxelKey key) const {
    return static_cast<std::size_t>((key.value * 0x9e3779b97f4a7c15ULL) >> shift_);
  }
  // Where `key` is, or the empty slot where it would go.
  [[nodiscard]] std::size_t position_of(VoxelKey key) const {
    std::size_t i = home_of(key);
    while (slots_[i].key != key && slots_[i].key != kEmpty) i = (i + 1) & (slots_.size() - 1);
    return i;
  }
  void grow();

  std::vector<Slot> slots_;  ///< Their number is a power of two.
  unsigned shift_ = 0;
  std::size_t size_ = 0;
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

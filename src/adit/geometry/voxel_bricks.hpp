// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "adit/geometry/voxel_grid.hpp"

namespace adit {

/// A number, 0 unless set, for each voxel of space. Voxels lie in bricks of 4 x 4 x 4, so that neighbours
/// share few cache lines; bricks that hold anything are found by hashing.
class VoxelBricks {
 public:
  static constexpr std::uint32_t kBrickVoxels = 64;  ///< 4 x 4 x 4.

  /// Reads voxels near one another; valid until the bricks change.
  class Reader {
   public:
    /// `bricks` must outlive the reader.
    explicit Reader(const VoxelBricks& bricks) : bricks_(bricks) {}
    /// The voxel's number. Keeps the brick at hand for the next voxel.
    [[nodiscard]] std::uint32_t operator()(VoxelKey key) {
      if (const VoxelKey brick = brick_of(key); brick != brick_) {
        brick_ = brick;
        const auto number = bricks_.table_.find(brick);
        values_ = number ? &bricks_.values_[std::size_t{*number} * kBrickVoxels] : nullptr;
      }
      return values_ == nullptr ? 0 : values_[place_in_brick(key)];
    }

   private:
    const VoxelBricks& bricks_;
    VoxelKey brick_ = VoxelKey::none();
    const std::uint32_t* values_ = nullptr;
  };

  /// The position of a voxel's number, for `operator[]`; valid until `clear` sets the voxel to 0.
  [[nodiscard]] std::uint32_t position_of(VoxelKey key);
  /// The number at a position that `position_of` gave, to be read or set.
  [[nodiscard]] std::uint32_t& operator[](std::uint32_t position) { return values_[position]; }
  /// Sets the voxel's number to 0.
  void clear(VoxelKey key);
  /// Prefetches the brick of `key` for a query that comes soon.
  void prefetch(VoxelKey key) const { table_.prefetch(brick_of(key)); }

 private:
  // The key of the brick's first voxel.
  [[nodiscard]] static VoxelKey brick_of(VoxelKey key) {
    return {key.value & ~(std::uint64_t{3} | std::uint64_t{3} << 21U | std::uint64_t{3} << 42U)};
  }
  [[nodiscard]] static std::uint32_t place_in_brick(VoxelKey key) {
    return static_cast<std::uint32_t>((key.value & 3U) | (key.value >> 19U & 12U) | (key.value >> 38U & 48U));
  }

  VoxelTable table_;  ///< From brick_of to the number of the brick.
  std::vector<std::uint32_t> values_;
  std::vector<std::uint32_t> free_;  ///< Bricks without a voxel, for the next new ones.
};

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/voxel_bricks.hpp"

namespace adit {

std::uint32_t VoxelBricks::position_of(VoxelKey key) {
  const auto next = free_.empty() ? static_cast<std::uint32_t>(values_.size() / kBrickVoxels) : free_.back();
  const auto known = table_.find_or_insert(brick_of(key), next);
  if (!known) {
    if (free_.empty())
      values_.resize(values_.size() + kBrickVoxels, 0);
    else
      free_.pop_back();
  }
  return known.value_or(next) * kBrickVoxels + place_in_brick(key);
}

void VoxelBricks::clear(VoxelKey key) {
  const auto number = table_.find(brick_of(key));
  if (!number) return;
  const auto brick = values_.begin() + static_cast<std::ptrdiff_t>(std::size_t{*number} * kBrickVoxels);
  brick[place_in_brick(key)] = 0;
  if (!std::all_of(brick, brick + kBrickVoxels, [](std::uint32_t value) { return value == 0; })) return;
  table_.erase(brick_of(key));
  free_.push_back(*number);
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/voxel_bricks.hpp"

#include <gtest/gtest.h>

#include <map>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

TEST(VoxelBricks, HoldsWhatAMapWouldHold) {
  const VoxelGrid grid(1.0);
  Rng rng(4);
  VoxelBricks bricks;
  std::map<std::uint64_t, std::pair<VoxelKey, std::uint32_t>> expected;
  const auto somewhere = [&] {
    const Eigen::Vector3f p(static_cast<float>(rng.uniform(-12.0, 12.0)),
                            static_cast<float>(rng.uniform(-12.0, 12.0)),
                            static_cast<float>(rng.uniform(-6.0, 6.0)));
    return *grid.key_of(p);
  };
  for (std::uint32_t i = 1; i <= 20'000; ++i) {
    const VoxelKey key = somewhere();
    if (rng.below(3) == 0) {
      if (expected.erase(key.value) > 0) bricks.clear(key);
    } else {
      bricks[bricks.position_of(key)] = i;
      expected[key.value] = {key, i};
    }
  }
  VoxelBricks::Reader read(bricks);
  for (const auto& [value, entry] : expected) EXPECT_EQ(read(entry.first), entry.second);
  for (int i = 0; i < 2000; ++i) {
    const VoxelKey key = somewhere();
    const auto found = expected.find(key.value);
    EXPECT_EQ(read(key), found == expected.end() ? 0U : found->second.second);
  }
}

TEST(VoxelBricks, NumbersStayWhereTheyAreWhileOthersComeAndGo) {
  const VoxelGrid grid(1.0);
  VoxelBricks bricks;
  const VoxelKey kept = *grid.key_of({0.5F, 0.5F, 0.5F});
  const std::uint32_t position = bricks.position_of(kept);
  bricks[position] = 7;
  for (int i = 1; i < 500; ++i) {
    const VoxelKey other = *grid.key_of({static_cast<float>(4 * i), 0.0F, 0.0F});
    bricks[bricks.position_of(other)] = 1;
    if (i % 2 == 0) bricks.clear(other);
  }
  EXPECT_EQ(bricks[position], 7U);
  EXPECT_EQ(bricks.position_of(kept), position);
}

}  // namespace
}  // namespace adit

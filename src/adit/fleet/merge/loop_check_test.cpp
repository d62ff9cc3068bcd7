// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/loop_check.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace adit {
namespace {

constexpr double kHeldAxis = 0.3;  // LoopClosure::weak_axis of a measurement that holds in all directions

LoopClosure loop_to(std::uint32_t keyframe, LoopVerdict verdict, double weak_axis) {
  LoopClosure loop;
  loop.to = {{1}, keyframe};
  loop.verdict = verdict;
  loop.weak_axis = weak_axis;
  return loop;
}

TEST(AcceptedWithoutSliding, KeepsAcceptedLoopsThatAreHeldInTheirOrder) {
  const std::vector<LoopClosure> kept = accepted_without_sliding(
      {loop_to(4, LoopVerdict::accepted, kHeldAxis), loop_to(3, LoopVerdict::rejected, kHeldAxis),
       loop_to(2, LoopVerdict::accepted, 0.0), loop_to(1, LoopVerdict::accepted, kHeldAxis)});
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept[0].to.index, 4U);
  EXPECT_EQ(kept[1].to.index, 1U);
  EXPECT_TRUE(accepted_without_sliding({}).empty());
}

}  // namespace
}  // namespace adit

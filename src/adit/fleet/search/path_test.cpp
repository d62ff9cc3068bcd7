// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/search/path.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

TEST(KeyframeAt, FindsKeyframesByMetresOfPath) {
  const OdometryChain chain({Pose(), Pose::translation_of(1, 0, 0), Pose::translation_of(1, 2, 0)},
                            {Matrix6::Identity(), Matrix6::Identity()});
  const std::vector<double>& path_m = chain.path_m();
  EXPECT_EQ(path_m, (std::vector<double>{0.0, 1.0, 3.0}));
  EXPECT_EQ(keyframe_at(path_m, 0.0), 0U);
  EXPECT_EQ(keyframe_at(path_m, 1.5), 2U);
  EXPECT_FALSE(keyframe_at(path_m, -0.1));
  EXPECT_FALSE(keyframe_at(path_m, 3.1));
  EXPECT_FALSE(keyframe_at({}, 0.0));
}

TEST(NearestLoop, IsNearestInMetresNotInKeyframes) {
  const std::vector<double> path_m = {0.0, 1.0, 2.0, 3.0, 10.0};
  const std::vector<PcmLoop> loops = {{0, 0, Pose()}, {1, 4, Pose()}};
  EXPECT_EQ(nearest_loop(loops, path_m, 3).b, 0U);  // three keyframes and 3 m away, not one and 7 m
  EXPECT_EQ(nearest_loop(loops, path_m, 4).b, 4U);
}

TEST(NearestBeside, IsTheFirstOfThoseAllowedWithinThreeMetres) {
  const OdometryChain chain({Pose(), Pose::translation_of(1, 0, 0), Pose::translation_of(1, 2, 0)},
                            {Matrix6::Identity(), Matrix6::Identity()});
  const auto any = [](std::uint32_t) { return true; };
  EXPECT_EQ(nearest_beside(chain, {1.0, 1.0, 0.0}, any), 1U);
  EXPECT_EQ(nearest_beside(chain, {1.0, 1.0, 0.0}, [](std::uint32_t k) { return k != 1; }), 2U);
  EXPECT_FALSE(nearest_beside(chain, {1.0, 5.0, 0.0}, any)) << "three metres are not side by side";
  EXPECT_EQ(nearest_beside(chain, {1.0, 4.9, 0.0}, any), 2U);
}

TEST(EvenlySpread, TakesTheMiddlesOfEqualParts) {
  EXPECT_EQ(evenly_spread(12, 3), (std::vector<std::uint32_t>{2, 6, 10}));
  EXPECT_EQ(evenly_spread(2, 3), (std::vector<std::uint32_t>{0, 1}));
  EXPECT_TRUE(evenly_spread(0, 3).empty());
}

}  // namespace
}  // namespace adit

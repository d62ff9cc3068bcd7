// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/simd.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

TEST(Simd, AnyFindsASingleLane) {
  EXPECT_FALSE(simd::any(simd::Int4{}));
  EXPECT_FALSE(simd::any(simd::Int8{}));
  for (int lane = 0; lane < 8; ++lane) {
    simd::Int8 eight = {};
    eight[lane] = -1;
    EXPECT_TRUE(simd::any(eight)) << lane;
    simd::Int4 four = {};
    four[lane % 4] = -1;
    EXPECT_TRUE(simd::any(four)) << lane;
  }
}

}  // namespace
}  // namespace adit

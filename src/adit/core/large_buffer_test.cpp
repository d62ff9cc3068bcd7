// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/large_buffer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <new>
#include <numeric>
#include <utility>

namespace adit {
namespace {

TEST(LargeBuffer, HoldsWhatIsWrittenAtEverySize) {
  for (const std::size_t size : {1U, 7U, 1000U, 262'143U, 262'144U, 1'000'001U}) {
    LargeBuffer buffer(size);
    ASSERT_EQ(buffer.size(), size);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(buffer.data()) % 64, 0U);
    std::iota(buffer.data(), buffer.data() + size, 0.0);
    const LargeBuffer moved = std::move(buffer);
    EXPECT_EQ(moved.data()[size - 1], static_cast<double>(size - 1));
    const std::size_t middle = size / 2;
    EXPECT_EQ(moved.data()[middle], static_cast<double>(middle));
  }
}

TEST(LargeBuffer, OfNothingIsEmpty) {
  EXPECT_EQ(LargeBuffer().size(), 0U);
  EXPECT_EQ(LargeBuffer(0).data(), nullptr);
}

TEST(LargeBuffer, SaysWhenThereIsNoRoom) {
  EXPECT_THROW(LargeBuffer(std::numeric_limits<std::size_t>::max() / 4), std::bad_alloc);
}

}  // namespace
}  // namespace adit

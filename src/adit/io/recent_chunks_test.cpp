// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/recent_chunks.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "adit/io/distinct_parts.hpp"

namespace adit {
namespace {

/// Which of the chunks have to be read, asked for in this order.
std::vector<std::size_t> read_of(const std::vector<std::size_t>& asked, std::size_t chunk_size,
                                 std::size_t most_bytes) {
  RecentChunks recent(most_bytes);
  std::vector<std::size_t> read;
  for (const std::size_t chunk : asked) {
    const auto records = recent.get(chunk, [&]() -> Result<std::string> {
      read.push_back(chunk);
      return std::string(chunk_size, 'x');
    });
    EXPECT_EQ((*records)->size(), chunk_size);
  }
  return read;
}

TEST(RecentChunks, AreFewAndHoldFewBytes) {
  using Chunks = std::vector<std::size_t>;
  EXPECT_EQ(read_of({0, 1, 2, 3, 0, 1, 2, 3}, 10, 100), Chunks({0, 1, 2, 3}));
  EXPECT_EQ(read_of({0, 1, 2, 3, 4, 0, 4}, 10, 100), Chunks({0, 1, 2, 3, 4, 0}));
  EXPECT_EQ(read_of({0, 1, 0, 1, 2, 0, 2}, 50, 100), Chunks({0, 1, 2, 0})) << "two of them fit";
  EXPECT_EQ(read_of({0, 0, 1, 1, 0}, 500, 100), Chunks({0, 1, 0})) << "one is kept however large it is";
}

TEST(DistinctParts, RefuseWhatOverlaps) {
  DistinctParts parts;
  EXPECT_TRUE(parts.add(100, 50));
  EXPECT_TRUE(parts.add(150, 10)) << "side by side";
  EXPECT_TRUE(parts.add(90, 10));
  EXPECT_TRUE(parts.add(100, 0)) << "nothing overlaps nothing";
  for (const auto& [begin, size] : std::vector<std::pair<std::uint64_t, std::uint64_t>>{
           {100, 50}, {100, 1}, {149, 1}, {99, 2}, {0, 1000}, {159, 5}, {95, 1}})
    EXPECT_FALSE(parts.add(begin, size)) << begin;
  EXPECT_FALSE(parts.add(200, UINT64_MAX - 100)) << "wraps around";
  EXPECT_TRUE(parts.add(160, 1000));
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/ascending.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

std::vector<Stamp> stamps_at(const std::vector<int>& seconds) {
  std::vector<Stamp> stamps;
  for (const int s : seconds) stamps.push_back(Stamp{} + from_seconds(s));
  return stamps;
}

using Indices = std::vector<std::size_t>;

TEST(LongestAscending, LeavesOutWhatLiesApart) {
  EXPECT_EQ(longest_ascending({}), Indices{});
  EXPECT_EQ(longest_ascending(stamps_at({1, 2, 3})), (Indices{0, 1, 2}));
  EXPECT_EQ(longest_ascending(stamps_at({1, 2, 2, 3})), (Indices{0, 1, 3})) << "sent twice";
  EXPECT_EQ(longest_ascending(stamps_at({1, 2, 9, 10, 3, 4, 5, 6})), (Indices{0, 1, 4, 5, 6, 7}));
  EXPECT_EQ(longest_ascending(stamps_at({5, 6, 0, 7, 8})), (Indices{0, 1, 3, 4}));
}

// Against all subsets.
TEST(LongestAscending, NoneIsLonger) {
  Rng rng(2);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<int> seconds;
    for (int i = 0; i < 9; ++i) seconds.push_back(static_cast<int>(rng.uniform(0.0, 8.0)));
    const Indices kept = longest_ascending(stamps_at(seconds));
    for (std::size_t i = 1; i < kept.size(); ++i) ASSERT_LT(seconds[kept[i - 1]], seconds[kept[i]]);
    std::size_t longest = 0;
    for (unsigned subset = 0; subset < 512; ++subset) {
      std::vector<int> part;
      for (std::size_t i = 0; i < 9; ++i)
        if ((subset >> i & 1U) != 0) part.push_back(seconds[i]);
      if (std::ranges::adjacent_find(part, std::greater_equal<>()) == part.end())
        longest = std::max(longest, part.size());
    }
    EXPECT_EQ(kept.size(), longest);
  }
}

TEST(LongestAscending, TheNoteCountsAndNamesTheFirst) {
  const std::vector<Stamp> stamps = stamps_at({1, 9, 2, 3});
  EXPECT_EQ(note_of_left_out("messages", stamps, longest_ascending(stamps)),
            "1 of 4 messages are left out, whose stamps do not ascend with the others' (check the "
            "driver's clock); the first is at 9.000000000 s");
  EXPECT_EQ(note_of_left_out("messages", stamps, Indices{0, 1, 2, 3}), std::nullopt);
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/disjoint_sets.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

TEST(DisjointSets, EqualsRelabelling) {
  Rng rng(1);
  for (int trial = 0; trial < 20; ++trial) {
    const std::size_t n = 1 + rng.below(40);
    DisjointSets sets(n);
    std::vector<std::size_t> label(n);
    for (std::size_t i = 0; i < n; ++i) label[i] = i;
    for (std::size_t k = 0; k < n; ++k) {
      const std::size_t a = rng.below(n);
      const std::size_t b = rng.below(n);
      sets.join(a, b);
      const std::size_t joined = label[a];
      const std::size_t stays = label[b];
      std::ranges::replace(label, joined, stays);
      for (std::size_t i = 0; i < n; ++i) {
        EXPECT_EQ(label[sets.find(i)], label[i]);
        EXPECT_EQ(sets.find(i) == sets.find(a), label[i] == label[a]);
      }
    }
  }
}

TEST(DisjointSets, TheSecondGroupsRepresentativeStays) {
  DisjointSets sets(4);
  sets.join(0, 1);
  EXPECT_EQ(sets.find(0), 1U);
  sets.join(1, 3);
  EXPECT_EQ(sets.find(0), 3U);
  EXPECT_EQ(sets.find(2), 2U);
}

}  // namespace
}  // namespace adit

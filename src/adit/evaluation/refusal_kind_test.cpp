// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/refusal_kind.hpp"

#include <gtest/gtest.h>

#include <set>

namespace adit {
namespace {

TEST(RefusalKind, IsReadFromTheSentenceOfTheDecision) {
  EXPECT_EQ(refusal_kind("no keyframe of a resembled one of b; drive on"), RefusalKind::no_loop);
  EXPECT_EQ(refusal_kind("none of 9 candidates could be registered (mostly: x)"), RefusalKind::no_loop);
  EXPECT_EQ(refusal_kind("scans differ at 3 of 8 places along the stretch that 4 loops align: tunnels"),
            RefusalKind::other_tunnel);
  EXPECT_EQ(refusal_kind("the walls differ: of the pairs of scans"), RefusalKind::other_tunnel);
  EXPECT_EQ(refusal_kind("only one of the robots met 12 things that stand on the floor"),
            RefusalKind::changed_place);
  EXPECT_EQ(refusal_kind("evidence 1.9 of 6.9: 15 of 15 places agree, 15 of them distinctive"),
            RefusalKind::too_little);
  EXPECT_EQ(refusal_kind("two hypotheses 40 m apart along the tunnel have similar support, evidence 8.0"),
            RefusalKind::rival);
  EXPECT_EQ(refusal_kind("taken back: with other merges it would put a-b where their own scans differ"),
            RefusalKind::taken_back);
  EXPECT_EQ(refusal_kind(""), RefusalKind::unknown);
}

TEST(RefusalKind, EachHasItsOwnName) {
  std::set<std::string_view> names;
  for (const RefusalKind kind : kRefusalKinds) EXPECT_TRUE(names.insert(to_string(kind)).second);
}

}  // namespace
}  // namespace adit

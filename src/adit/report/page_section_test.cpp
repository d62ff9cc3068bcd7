// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/page_section.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

TEST(PageSection, OnlyWhatIsBetweenTheMarksChanges) {
  const std::string page = "before\n<!-- x begin -->\nold\n<!-- x end -->\nafter\n";
  const Result<std::string> changed = with_section(page, "x", "new\n");
  ASSERT_TRUE(changed);
  EXPECT_EQ(*changed, "before\n<!-- x begin -->\nnew\n<!-- x end -->\nafter\n");
  EXPECT_EQ(with_section(*changed, "x", "old\n").value(), page);
}

TEST(PageSection, APageWithoutTheMarksIsRefused) {
  EXPECT_FALSE(with_section("text\n", "x", ""));
  EXPECT_FALSE(with_section("<!-- x begin -->\n", "x", ""));
  EXPECT_FALSE(with_section("<!-- x end -->\n<!-- x begin -->\n", "x", ""));
}

}  // namespace
}  // namespace adit

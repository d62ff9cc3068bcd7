// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/refusal_kind.hpp"

#include <gtest/gtest.h>

#include <set>

namespace adit {
namespace {

TEST(RefusalKind, EachHasItsOwnNameAndIsReadFromIt) {
  std::set<std::string_view> names;
  for (const RefusalKind kind : kRefusalKinds) {
    EXPECT_TRUE(names.insert(to_string(kind)).second);
    EXPECT_EQ(refusal_kind(to_string(kind)), kind);
  }
}

TEST(RefusalKind, OtherWordsNameNone) {
  EXPECT_EQ(refusal_kind(""), RefusalKind::unknown);
  EXPECT_EQ(refusal_kind("scans differ at 3 of 8 places"), RefusalKind::unknown);
}

}  // namespace
}  // namespace adit

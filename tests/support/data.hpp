// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace adit::test {

/// Where the real data lie; a test that needs one asks with ADIT_NEED_DATA first.
inline std::filesystem::path shared_data(const std::string& relative) {
  return std::filesystem::path(ADIT_SHARED_DATA) / relative;
}

/// With ADIT_REQUIRE_DATA in the environment, as in CI where the data exist, an absent file is a failure.
inline bool data_are_required() { return std::getenv("ADIT_REQUIRE_DATA") != nullptr; }

}  // namespace adit::test

/// Leaves the test as SKIPPED where the file is absent, or as failed where the data are required.
#define ADIT_NEED_DATA(relative)                                                                        \
  if (!std::filesystem::exists(::adit::test::shared_data(relative))) {                                  \
    if (::adit::test::data_are_required())                                                              \
      GTEST_FAIL() << "no " << ::adit::test::shared_data(relative) << ", and ADIT_REQUIRE_DATA is set"; \
    GTEST_SKIP() << "no " << ::adit::test::shared_data(relative) << "; this test needs the real data";  \
  }                                                                                                     \
  static_assert(true)

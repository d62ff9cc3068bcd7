// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace adit::test {

/// Where the real data lie; a test that needs one asks with ADIT_NEED_DATA first.
inline std::filesystem::path shared_data(const std::string& relative) {
  return std::filesystem::path(ADIT_SHARED_DATA) / relative;
}

}  // namespace adit::test

/// Leaves the test as SKIPPED where the file is absent.
#define ADIT_NEED_DATA(relative)                                                                       \
  if (!std::filesystem::exists(::adit::test::shared_data(relative))) {                                 \
    GTEST_SKIP() << "no " << ::adit::test::shared_data(relative) << "; this test needs the real data"; \
  }                                                                                                    \
  static_assert(true)

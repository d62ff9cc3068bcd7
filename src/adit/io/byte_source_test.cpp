// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/byte_source.hpp"

#include <gtest/gtest.h>

#include "support/files.hpp"

namespace adit {
namespace {

using test::put_file;
using test::TemporaryFolder;

TEST(ByteSource, ReadsInsideTheFileOnly) {
  const TemporaryFolder folder;
  put_file(folder / "a", "0123456789");
  const Result<ByteSource> file = open_source(folder / "a");
  ASSERT_TRUE(file);
  for (const ByteSource& source : {*file, memory_source("0123456789")}) {
    EXPECT_EQ(source.read(3, 4), "3456");
    EXPECT_EQ(source.read(10, 0), "");
    EXPECT_ERROR(source.read(8, 3), "past the end at byte 10");
    EXPECT_FALSE(source.read(~std::uint64_t{0}, 2));
    EXPECT_FALSE(source.read(2, ~std::uint64_t{0}));
  }
  EXPECT_ERROR(open_source(folder / "absent"), "no such file");
  EXPECT_FALSE(open_source(folder.path()));
}

}  // namespace
}  // namespace adit

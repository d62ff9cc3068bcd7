// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/cdr.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

TEST(Cdr, AlignsToTheSizeOfTheNumber) {
  CdrWriter writer;
  writer.number(std::uint8_t{7}).number(std::uint32_t{1}).text("ab").number(2.5);
  const std::string bytes = writer.take();
  // 4 of head; byte at 0, number at 4, text at 8 (4 + "ab\0" = 7), double at 16.
  EXPECT_EQ(bytes.size(), 4U + 24U);
  MessageReader reader(bytes);
  EXPECT_EQ(reader.number<std::uint8_t>(), 7);
  EXPECT_EQ(reader.number<std::uint32_t>(), 1U);
  EXPECT_EQ(reader.text(), "ab");
  EXPECT_EQ(reader.number<double>(), 2.5);
  EXPECT_TRUE(reader.ok());
  EXPECT_EQ(reader.number<std::uint8_t>(), 0);
  EXPECT_FALSE(reader.ok());
}

TEST(Cdr, BigEndian) {
  MessageReader reader(std::string_view("\0\0\0\0\0\0\1\2", 8));
  EXPECT_EQ(reader.number<std::uint32_t>(), 0x102U);
  EXPECT_FALSE(MessageReader("\x07\x07").ok());
}

}  // namespace
}  // namespace adit

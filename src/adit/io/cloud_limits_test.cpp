// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Numbers in the files of clouds that the types beside them cannot hold.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "adit/core/format.hpp"
#include "adit/io/packed_cloud.hpp"
#include "adit/io/pcd.hpp"
#include "adit/io/ply.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

/// What the word becomes as a number of that type; "out of range" where it is refused.
std::string stored(ScalarType type, std::string_view word) {
  std::string bytes;
  if (!append_scalar(bytes, type, word)) return "out of range";
  return format("{}", load_scalar(type, bytes.data(), std::endian::little));
}

TEST(AppendScalar, TakesWhatTheTypeHoldsAndNoMore) {
  using enum ScalarType;
  EXPECT_EQ(stored(uint8, "-1"), "out of range");
  EXPECT_EQ(stored(uint8, "-1.0"), "out of range");
  EXPECT_EQ(stored(uint8, "-0.5"), "0");
  EXPECT_EQ(stored(uint8, "255.9"), "255");
  EXPECT_EQ(stored(uint8, "256.0"), "out of range");
  EXPECT_EQ(stored(int8, "-128.0"), "-128");
  EXPECT_EQ(stored(int8, "-129.0"), "out of range");
  EXPECT_EQ(stored(int32, "1e3"), "1000");
  EXPECT_EQ(stored(int64, "9223372036854775808.0"), "out of range");
  EXPECT_EQ(stored(int64, "-9223372036854775808.0"), "-9.223372036854776e+18");
  EXPECT_EQ(stored(uint64, "18446744073709551616.0"), "out of range");
  EXPECT_EQ(stored(uint64, "1e19"), "1e+19");
  EXPECT_EQ(stored(uint16, "nan"), "out of range");
  EXPECT_EQ(stored(float32, "1e39"), "out of range");
  EXPECT_EQ(stored(float32, "nan"), "nan");
}

TEST(CloudLimits, AnIntegerOutOfRangeIsNamed) {
  EXPECT_ERROR(
      read_pcd("VERSION .7\nFIELDS x y z ring\nSIZE 4 4 4 1\nTYPE F F F U\nWIDTH 1\nHEIGHT 1\nPOINTS 1\n"
               "DATA ascii\n1 2 3 -1\n"),
      "line 9: '-1' is not a value of field 'ring'");
  EXPECT_ERROR(read_ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                        "property float z\nproperty uchar ring\nend_header\n1 2 3 -1\n"),
               "line 9: vertex 0 of 1: no value for 'ring'");
}

TEST(CloudLimits, AListCannotBeLongerThanThePly) {
  // The largest rounds to 2^64, whose cast to std::size_t has no meaning.
  for (const std::uint64_t count : {~std::uint64_t{0}, std::uint64_t{1} << 63U, std::uint64_t{1000}}) {
    std::string file =
        "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uint64 uchar vertex_indices\n"
        "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    append_little_endian(file, count);
    for (const float coordinate : {1.0F, 2.0F, 3.0F}) append_little_endian(file, coordinate);
    EXPECT_ERROR(read_ply(file), "face 0 of 1: no value for 'vertex_indices'");
  }
}

}  // namespace
}  // namespace adit

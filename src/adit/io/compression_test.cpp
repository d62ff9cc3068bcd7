// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/compression.hpp"

#include <bzlib.h>
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <sys/resource.h>

#include <algorithm>
#include <string>
#include <vector>

#include "adit/core/rng.hpp"
#include "adit/io/crc32.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

TEST(Compression, RoundTripAndDamage) {
  const std::string text = "abcabcabc" + std::string(5000, 'x');
  const std::string packed = compress_zstd(text);
  EXPECT_LT(packed.size(), text.size());
  EXPECT_EQ(decompress(packed, "zstd", text.size()), text);
  EXPECT_FALSE(decompress(packed, "zstd", text.size() - 1));
  EXPECT_FALSE(decompress(packed, "zstd", text.size() + 1));
  EXPECT_FALSE(decompress(packed.substr(0, packed.size() / 2), "zstd", text.size()));
  EXPECT_FALSE(decompress(packed, "lz4", text.size()));
  EXPECT_FALSE(decompress("", "lz4", 0U));
  EXPECT_FALSE(decompress(text, "", 3));
  EXPECT_ERROR(decompress(text, "lzma", 3), "lz4, zstd and bz2 are known");
  EXPECT_ERROR(decompress(packed, "zstd", std::size_t{1} << 50U), "1 GiB is the most");
}

TEST(Compression, AClaimThatSoFewBytesCannotHoldTakesNoMemory) {
  // As much as a byte can stand for is no false claim.
  std::string zeros;
  zeros.resize(10'000'000);
  EXPECT_EQ(decompress(compress_zstd(zeros), "zstd", zeros.size()).value(), zeros);
  for (const char* compression : {"zstd", "lz4"})
    EXPECT_ERROR(decompress(std::string("\x04\x22\x4D\x18 and some more", 18), compression, 1U << 30U),
                 compression == std::string("lz4") ? "cannot hold" : "not a zstd frame");
  const std::string few = compress_zstd("few");
  EXPECT_ERROR(decompress(few, "zstd", 1U << 30U), "holds 3 bytes");
  EXPECT_ERROR(decompress(few + few, "zstd", 1U << 30U), "cannot hold");
  EXPECT_EQ(decompress(few + few, "zstd", 6U), "fewfew");
}

/// The most memory that the process has had, bytes.
std::size_t most_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024U;
}

TEST(Compression, ZstdTakesMemoryAsDataCome) {
  // More than the usual a byte, in frames that fit: not at once, but all of it.
  const std::string zeros(3'000'000, '\0');
  const std::string packed = compress_zstd(zeros);
  ASSERT_LT(packed.size(), zeros.size() / 64);
  EXPECT_EQ(decompress(packed + packed, "zstd", 2 * zeros.size()).value(), zeros + zeros);
  EXPECT_ERROR(decompress(packed + packed, "zstd", 2 * zeros.size() - 1), "expand to more than");
  EXPECT_ERROR(decompress(packed + packed, "zstd", 2 * zeros.size() + 1), "expand to 6000000 bytes");
  EXPECT_ERROR(decompress(packed + packed.substr(0, packed.size() - 10), "zstd", 2 * zeros.size()),
               "end early");
  // Where the memory is full when the data end.
  const std::string mebibyte(std::size_t{1} << 20U, '\0');
  EXPECT_EQ(
      decompress(compress_zstd(mebibyte) + compress_zstd(mebibyte), "zstd", 2 * mebibyte.size()).value(),
      mebibyte + mebibyte);
  // So many bytes that they could be a gibibyte, and are a few hundred kilobytes.
  std::string claims;
  while (claims.size() < 33'000) claims += compress_zstd("few");
  const std::size_t before = most_memory();
  EXPECT_ERROR(decompress(claims, "zstd", std::size_t{1} << 30U), "expand to");
  EXPECT_LT(most_memory(), before + 100'000'000U);
}

// As the map of some kilometres is.
TEST(Compression, ZstdOfMoreThanAGibibyte) {
  std::string content((std::size_t{1} << 30U) + 1000, '\0');
  std::uint64_t state = 1;
  for (std::size_t i = 0; i < content.size(); i += 8) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    content[i] = static_cast<char>(state >> 56U);
  }
  const std::string packed = compress_zstd(content);
  ASSERT_GT(packed.size(), content.size() / 64);
  const Result<std::string> back = decompress(packed, "zstd", content.size());
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_TRUE(*back == content);
}

TEST(Compression, Bz2OfAnySizeAndItsDamage) {
  for (const std::size_t size : {0U, 1U, 100U, 1U << 20U, (1U << 20U) + 1U, 5'000'000U}) {
    std::string text;
    for (std::size_t i = 0; i < size; ++i) text += static_cast<char>(i * i / 1000 % 251);
    std::string packed(2 * size + 1000, '\0');
    auto packed_size = static_cast<unsigned>(packed.size());
    ASSERT_EQ(BZ2_bzBuffToBuffCompress(packed.data(), &packed_size, text.data(), static_cast<unsigned>(size),
                                       9, 0, 0),
              BZ_OK);
    packed.resize(packed_size);
    EXPECT_EQ(decompress(packed, "bz2", size), text) << size;
    EXPECT_ERROR(decompress(packed, "bz2", size + 1), "expand to");
    EXPECT_FALSE(decompress(packed, "bz2", std::size_t{1} << 30U));
    if (size == 0) continue;
    EXPECT_ERROR(decompress(packed, "bz2", size - 1), "expand to");
    EXPECT_ERROR(decompress(packed.substr(0, packed.size() / 2), "bz2", size), "end early");
  }
}

TEST(Compression, Lz4Frames) {
  // By hand: 6 literals, a match of 7 bytes 6 back, 5 literals; frame head and end mark around the one block.
  const std::string frame = std::string("\x04\x22\x4d\x18\x60\x40\x82\x0f\0\0\0", 11) +
                            "\x63"
                            "hello " +
                            std::string("\x06\0", 2) +
                            "\x50"
                            "ello\n" +
                            std::string(4, '\0');
  EXPECT_EQ(decompress(frame, "lz4", 18), "hello hello hello\n");
  EXPECT_FALSE(decompress(frame, "lz4", 17));
  EXPECT_FALSE(decompress(frame, "lz4", 19));
  for (std::size_t size = 0; size < frame.size(); ++size)
    EXPECT_FALSE(decompress(frame.substr(0, size), "lz4", 18));
}

TEST(Lzf, RoundTripAndDamage) {
  std::string text = "abcabcabc" + std::string(5000, 'x');
  for (int i = 0; i < 500; ++i) text += static_cast<char>(i * i % 251);
  const std::string packed = compress_lzf(text);
  EXPECT_LT(packed.size(), text.size());
  EXPECT_EQ(decompress_lzf(packed, text.size()), text);
  EXPECT_ERROR(decompress_lzf(packed, text.size() - 1), "damaged LZF data");
  EXPECT_ERROR(decompress_lzf(packed, text.size() + 1), "expand to 5509 bytes");
  EXPECT_FALSE(decompress_lzf(packed.substr(0, packed.size() - 1), text.size()));
  EXPECT_ERROR(decompress_lzf("z", std::size_t{1} << 40U), "the size is damaged");
  EXPECT_EQ(decompress_lzf(compress_lzf(""), 0), "");
}

TEST(Crc32, IsTheOneOfMcapAndContinues) {
  EXPECT_EQ(crc32("123456789"), 0xCBF43926U);  // the check value of the CRC catalogue
  EXPECT_EQ(crc32("6789", crc32("12345")), 0xCBF43926U);
  EXPECT_EQ(crc32("", 17U), 17U);
}

TEST(Compression, OfDataThatAreCutTheFrontIsGiven) {
  Rng rng(3);
  std::string bytes(1'000'000, '\0');
  for (char& c : bytes) c = static_cast<char>(rng.uniform(0.0, 32.0));
  const std::string packed = compress_zstd(bytes);
  std::size_t last = 0;
  for (const double share : {0.0, 0.2, 0.5, 0.8, 1.0}) {
    const auto size = static_cast<std::size_t>(share * static_cast<double>(packed.size()));
    const std::string front =
        decompress_front(std::string_view(packed).substr(0, size), "zstd", bytes.size());
    EXPECT_TRUE(bytes.starts_with(front));
    EXPECT_GE(front.size(), last);
    EXPECT_GE(static_cast<double>(front.size() + 200'000), share * 1e6) << "blocks are of 128 kB";
    last = front.size();
  }
  EXPECT_EQ(last, bytes.size());
  EXPECT_EQ(decompress_front(packed, "zstd", 10), bytes.substr(0, 10));
  EXPECT_EQ(decompress_front(bytes, "", 10), bytes.substr(0, 10));
  for (const char* compression : {"zstd", "lz4", "bz2", "unheard of"}) {
    EXPECT_EQ(decompress_front("no such frame", compression, 100), "") << compression;
    EXPECT_EQ(decompress_front("", compression, 100), "") << compression;
  }
}

/// 210 kB: numbers, of which every compression makes less, and a run that LZ4 counts in some hundred bytes.
std::string shrinking_text() {
  Rng rng(5);
  std::string text;
  while (text.size() < 150'000) text += std::to_string(rng.below(1000)) + " ";
  return text.insert(60'000, 60'000, 'x');
}

std::string in_lz4_frame(const std::string& bytes, const LZ4F_frameInfo_t& frame) {
  LZ4F_preferences_t how = {};
  how.frameInfo = frame;
  std::string out(LZ4F_compressFrameBound(bytes.size(), &how), '\0');
  out.resize(LZ4F_compressFrame(out.data(), out.size(), bytes.data(), bytes.size(), &how));
  return out;
}

/// As rosbag has them: one block holds a chunk.
LZ4F_frameInfo_t lz4_of_ros1() {
  LZ4F_frameInfo_t frame = {};
  frame.blockSizeID = LZ4F_max1MB;
  frame.blockMode = LZ4F_blockIndependent;
  frame.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  return frame;
}

/// That, and blocks of 64 kB, which refer back to each other, without and with checksums.
std::vector<LZ4F_frameInfo_t> kinds_of_lz4() {
  LZ4F_frameInfo_t with_checksums = {};
  with_checksums.blockChecksumFlag = LZ4F_blockChecksumEnabled;
  return {lz4_of_ros1(), LZ4F_frameInfo_t{}, with_checksums};
}

TEST(Compression, OfLz4TheBlockThatIsCutIsGivenToo) {
  const std::string text = shrinking_text();
  for (const LZ4F_frameInfo_t& frame : kinds_of_lz4()) {
    const std::string packed = in_lz4_frame(text, frame);
    ASSERT_LT(packed.size(), text.size());
    std::size_t longest = 0;
    for (std::size_t size = 0; size < packed.size(); size += 211) {
      const std::string front =
          decompress_front(std::string_view(packed).substr(0, size), "lz4", text.size());
      ASSERT_TRUE(text.starts_with(front)) << size;
      ASSERT_GE(front.size() + 3000, longest) << size;  // some bytes at the cut may be of no use
      longest = std::max(longest, front.size());
    }
    EXPECT_GT(longest + 5000, text.size());
    EXPECT_EQ(decompress_front(packed, "lz4", text.size()), text);
    const std::string_view most_of_it = std::string_view(packed).substr(0, packed.size() - 100);
    EXPECT_EQ(decompress_front(most_of_it, "lz4", 90'000), text.substr(0, 90'000));
  }
}

TEST(Compression, OfLz4TheLastBytesInFrontOfACutAreNotGiven) {
  Rng rng(11);
  std::string noise(10'000, '\0');
  for (char& c : noise) c = static_cast<char>(1 + rng.below(255));
  const std::string frame = in_lz4_frame(noise, {});
  constexpr std::size_t kHead = 11;  // of the frame and of its block, which is stored as it is
  ASSERT_EQ(frame.substr(kHead, noise.size()), noise);
  EXPECT_EQ(decompress_front(frame.substr(0, 5000), "lz4", noise.size()), noise.substr(0, 5000 - kHead - 64));
  EXPECT_EQ(decompress_front(frame.substr(0, 50), "lz4", noise.size()), "");
}

TEST(Compression, ZerosBehindACutAreNotTakenForData) {
  const std::string text = shrinking_text();
  const auto expect_none = [&](const std::string& whole, const std::string& compression) {
    for (std::size_t size = 0; size < whole.size(); size += 1999) {
      const std::string cut = whole.substr(0, size);
      const std::string front = decompress_front(cut, compression, text.size());
      ASSERT_TRUE(text.starts_with(front)) << compression << " cut at " << size;
      for (const std::size_t num_zeros : {std::size_t{17}, std::size_t{4096}, 2 * text.size()})
        ASSERT_EQ(decompress_front(cut + std::string(num_zeros, '\0'), compression, text.size()), front)
            << compression << " cut at " << size << ", zeros: " << num_zeros;
    }
  };
  for (const LZ4F_frameInfo_t& frame : kinds_of_lz4()) expect_none(in_lz4_frame(text, frame), "lz4");
  expect_none(compress_zstd(text), "zstd");
  expect_none(text, "");
  for (const char* compression : {"", "zstd", "lz4", "bz2"})
    EXPECT_EQ(decompress_front(std::string(5000, '\0'), compression, 5000), "") << compression;
}

TEST(Compression, OfLz4WhatStandsInFrontOfADamagedByteIsRight) {
  const std::string text = shrinking_text();
  const std::string whole = in_lz4_frame(text, lz4_of_ros1());
  const std::string cut = whole.substr(0, whole.size() / 4 * 3);
  int num_wrong = 0;
  for (std::size_t at = 100; at < cut.size(); at += 997) {
    std::string damaged = cut;
    damaged[at] = static_cast<char>(damaged[at] ^ 1);
    const std::string front = decompress_front(damaged, "lz4", text.size());
    const std::string before = decompress_front(cut.substr(0, at), "lz4", text.size());
    const std::size_t num_right = std::min(front.size(), before.size());
    ASSERT_EQ(front.substr(0, num_right), text.substr(0, num_right)) << at;
    if (!text.starts_with(front)) ++num_wrong;
  }
  EXPECT_GT(num_wrong, 0) << "the checksum stands at the end, which is not there";
  std::string damaged = whole;
  damaged[5000] = static_cast<char>(damaged[5000] ^ 1);
  EXPECT_EQ(decompress_front(damaged, "lz4", text.size()), "") << "here it is";
}

TEST(Compression, OfLz4FramesThatHoldNoDataNothingIsGiven) {
  const std::string skippable("\x50\x2A\x4D\x18\x05\0\0\0", 8);
  for (const std::string& rest :
       {std::string(), std::string("abc"), std::string("abcde"), std::string(99, 'a')})
    EXPECT_EQ(decompress_front(skippable + rest, "lz4", 100), "") << rest;
}

TEST(Compression, OfBz2WholeBlocksAreGivenUnlessTheyAreDamaged) {
  std::string text = shrinking_text();
  std::string packed(text.size(), '\0');
  auto packed_size = static_cast<unsigned>(packed.size());
  ASSERT_EQ(BZ2_bzBuffToBuffCompress(packed.data(), &packed_size, text.data(),
                                     static_cast<unsigned>(text.size()), 1, 0, 0),
            BZ_OK);
  packed.resize(packed_size);
  std::size_t last = 0;
  for (std::size_t size = 0; size < packed.size(); size += packed.size() / 20) {
    const std::string front = decompress_front(packed.substr(0, size), "bz2", text.size());
    ASSERT_TRUE(text.starts_with(front)) << size;
    ASSERT_GE(front.size(), last) << size;
    last = front.size();
  }
  EXPECT_GT(last, 100'000U) << "a block is of 100 kB, of which runs take next to none";
  EXPECT_EQ(decompress_front(packed, "bz2", text.size()), text);
  EXPECT_EQ(decompress_front(packed, "bz2", 1000), text.substr(0, 1000));
  packed[100] = static_cast<char>(packed[100] ^ 1);
  EXPECT_EQ(decompress_front(packed.substr(0, packed.size() - 100), "bz2", text.size()), "");
}

}  // namespace
}  // namespace adit

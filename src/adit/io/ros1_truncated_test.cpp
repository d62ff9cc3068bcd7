// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Bags of ROS 1 that end in a compressed chunk.
#include <bzlib.h>
#include <gtest/gtest.h>
#include <lz4frame.h>

#include <set>
#include <string>

#include "adit/core/format.hpp"
#include "adit/core/rng.hpp"
#include "adit/io/ros1_bag.hpp"
#include "support/files.hpp"
#include "support/ros1_records.hpp"

namespace adit {
namespace {

using test::ros1::bag_header;
using test::ros1::chunk_info_record;
using test::ros1::chunk_record;
using test::ros1::connection_record;
using test::ros1::index_record;
using test::ros1::message_record;

/// As recorders do: lz4 in one block; bz2 in blocks of 100 kB, as 900 kB are more than most chunks.
std::string compressed_as(const std::string& compression, std::string records) {
  if (compression == "bz2") {
    auto size = static_cast<unsigned>(records.size() + records.size() / 100 + 600);
    std::string out(size, '\0');
    EXPECT_EQ(BZ2_bzBuffToBuffCompress(out.data(), &size, records.data(),
                                       static_cast<unsigned>(records.size()), 1, 0, 0),
              BZ_OK);
    return out.substr(0, size);
  }
  LZ4F_preferences_t how = {};
  how.frameInfo.blockSizeID = LZ4F_max1MB;
  how.frameInfo.blockMode = LZ4F_blockIndependent;
  how.frameInfo.contentChecksumFlag = LZ4F_contentChecksumEnabled;
  std::string out(LZ4F_compressFrameBound(records.size(), &how), '\0');
  out.resize(LZ4F_compressFrame(out.data(), out.size(), records.data(), records.size(), &how));
  return out;
}

/// A kilobyte, of which every compression makes less.
std::string numbered_text(std::size_t m) {
  Rng rng(m);
  std::string text = format("message {} ", m);
  while (text.size() < 1000) text += format("{} ", rng.below(1000));
  return text;
}

constexpr std::uint32_t kNumTexts = 300;

std::string records_of_texts() {
  std::string records = connection_record(0, "/notes", "std_msgs/String");
  for (std::uint32_t m = 0; m < kNumTexts; ++m)
    records += message_record({0, {m * 1'000'000'000LL}, numbered_text(m)});
  return records;
}

/// A bag without index, of one chunk.
struct BagOfOneChunk {
  std::string bytes;
  std::size_t chunk = 0;  ///< Where it begins,
  std::size_t data = 0;   ///< and its data.
};

/// `is_finished`: the recorder came to state the sizes of the chunk.
BagOfOneChunk bag_of_one_chunk(const std::string& compression, const std::string& records, bool is_finished) {
  const std::string data = compressed_as(compression, records);
  const std::string front = std::string(test::ros1::kMagic) + bag_header(0, 0, 0);
  const std::size_t head = chunk_record(compression, 0, "").size();
  const std::string chunk =
      is_finished ? chunk_record(compression, records.size(), data) : chunk_record(compression, 0, "") + data;
  return {front + chunk, front.size(), front.size() + head};
}

BagOfOneChunk bag_of_texts(const std::string& compression, bool is_finished = true) {
  return bag_of_one_chunk(compression, records_of_texts(), is_finished);
}

/// The file as it is when it ends behind this share of the chunk's data.
std::string cut_in_data(const BagOfOneChunk& bag, double share) {
  return bag.bytes.substr(
      0, bag.data + static_cast<std::size_t>(share * static_cast<double>(bag.bytes.size() - bag.data)));
}

/// The first texts, as they were written, and one warning that says how many.
void expect_front_of_texts(const Result<Bag>& bag, std::size_t least, std::size_t most) {
  ASSERT_TRUE(bag) << bag.error().message;
  EXPECT_GE(bag->messages.size(), least);
  EXPECT_LE(bag->messages.size(), most);
  for (std::size_t m = 0; m < bag->messages.size(); ++m)
    ASSERT_EQ(bag->read(bag->messages[m]), numbered_text(m)) << m;
  ASSERT_EQ(bag->warnings.size(), 1U);
  EXPECT_NE(
      bag->warnings[0].find(format("; the {} messages before the break are read", bag->messages.size())),
      std::string::npos)
      << bag->warnings[0];
}

TEST(Ros1Truncated, WhatLiesInFrontOfTheCutIsRead) {
  // bz2 has three blocks of 100 kB in 300 kB of messages. Those that can be read at least; 0: none.
  struct Cut {
    double share;
    std::size_t lz4;
    std::size_t bz2;
  };
  for (const auto& [share, lz4, bz2] : {Cut{0.0, 0, 0}, Cut{0.3, 85, 0}, Cut{0.5, 145, 92},
                                        Cut{0.7, 205, 187}, Cut{0.9, 265, 187}, Cut{0.99, 290, 280}}) {
    for (const std::string compression : {"lz4", "bz2"}) {
      const std::size_t least = compression == "lz4" ? lz4 : bz2;
      for (const bool is_finished : {true, false}) {
        SCOPED_TRACE(format("{} cut at {}, {}", compression, share, is_finished ? "finished" : "unfinished"));
        const Result<Bag> cut =
            open_ros1_bag(memory_source(cut_in_data(bag_of_texts(compression, is_finished), share)));
        if (least == 0) {
          EXPECT_ERROR(cut, "the file breaks off before its first whole message: the chunk at byte ");
        } else {
          ASSERT_NO_FATAL_FAILURE(expect_front_of_texts(cut, least, least + 12));
        }
      }
    }
  }
}

TEST(Ros1Truncated, OfDataThatAreWholeAllIsRead) {
  for (const std::string compression : {"lz4", "bz2"}) {
    const Result<Bag> finished = open_ros1_bag(memory_source(bag_of_texts(compression).bytes));
    ASSERT_TRUE(finished) << finished.error().message;
    EXPECT_EQ(finished->messages.size(), kNumTexts);
    EXPECT_TRUE(finished->warnings.empty());
    // The recorder may have had more.
    expect_front_of_texts(open_ros1_bag(memory_source(bag_of_texts(compression, false).bytes)), kNumTexts,
                          kNumTexts);
  }
}

TEST(Ros1Truncated, TheWarningSaysWhereWhyAndWhatIsNotVerified) {
  const BagOfOneChunk lz4 = bag_of_texts("lz4");
  const Bag cut = open_ros1_bag(memory_source(cut_in_data(lz4, 0.5))).value();
  EXPECT_EQ(
      cut.warnings.at(0),
      format("the file breaks off: the chunk at byte {} reaches past the end of the file; the {} messages "
             "before the break are read, those of that chunk not verified, as its checksum stands at its "
             "end; where the recording went on, copy the file again",
             lz4.chunk, cut.messages.size()));
  const BagOfOneChunk bz2 = bag_of_texts("bz2", false);
  const Bag killed = open_ros1_bag(memory_source(cut_in_data(bz2, 0.5))).value();
  EXPECT_EQ(killed.warnings.at(0), format("the file breaks off: the chunk at byte {} is unfinished; the {} "
                                          "messages before the break are read",
                                          bz2.chunk, killed.messages.size()))
      << "a copy of what a recorder left that was killed is no better";
  EXPECT_ERROR(open_ros1_bag(memory_source(cut_in_data(lz4, 0.0))), "reaches past the end of the file; copy");
  EXPECT_ERROR(open_ros1_bag(memory_source(cut_in_data(bz2, 0.0))),
               "is unfinished; nothing can be read of this one; if its recorder still ran, copy it again");
}

TEST(Ros1Truncated, ZerosBehindTheCutAreNoMessages) {
  for (const std::string compression : {"lz4", "bz2"})
    for (const bool is_finished : {true, false})
      for (const double share : {0.5, 0.6, 0.7, 0.8}) {
        const BagOfOneChunk whole = bag_of_texts(compression, is_finished);
        const std::string bytes = cut_in_data(whole, share);
        const std::size_t num_read = open_ros1_bag(memory_source(bytes)).value().messages.size();
        // As a loss of power leaves them, within the data or, of an unfinished chunk, beyond.
        for (const std::size_t num_zeros : {std::size_t{1}, std::size_t{4096}, 2 * whole.bytes.size()}) {
          if (is_finished && bytes.size() + num_zeros >= whole.bytes.size()) continue;
          SCOPED_TRACE(format("{} cut at {}, zeros: {}", compression, share, num_zeros));
          const std::string padded = bytes + std::string(num_zeros, '\0');
          ASSERT_NO_FATAL_FAILURE(
              expect_front_of_texts(open_ros1_bag(memory_source(padded)), num_read, num_read));
        }
      }
}

TEST(Ros1Truncated, WhatLiesInFrontOfADamagedByteIsRight) {
  const BagOfOneChunk whole = bag_of_texts("lz4");
  const std::string cut = cut_in_data(whole, 0.9);
  for (const double share : {0.3, 0.5, 0.8}) {
    const std::string before = cut_in_data(whole, share);
    std::string damaged = cut;
    damaged[before.size()] = static_cast<char>(damaged[before.size()] ^ 1);
    const std::size_t num_right = open_ros1_bag(memory_source(before)).value().messages.size();
    const Bag bag = open_ros1_bag(memory_source(damaged)).value();
    std::set<std::string> texts;  // in no order: times may be damaged
    for (const BagMessage& message : bag.messages) texts.insert(bag.read(message).value());
    for (std::size_t m = 0; m < num_right; ++m) ASSERT_TRUE(texts.contains(numbered_text(m))) << m;
  }
  // Blocks of bz2 have checksums.
  std::string damaged = cut_in_data(bag_of_texts("bz2"), 0.9);
  damaged[damaged.size() / 10] = static_cast<char>(damaged[damaged.size() / 10] ^ 1);
  EXPECT_ERROR(open_ros1_bag(memory_source(damaged)), "before its first whole message");
}

TEST(Ros1Truncated, ADamagedByteInAChunkThatIsWholeIsAnError) {
  for (const std::string compression : {"bz2", "lz4"}) {
    BagOfOneChunk bag = bag_of_texts(compression);
    char& byte = bag.bytes[(bag.data + bag.bytes.size()) / 2];
    byte = static_cast<char>(byte ^ 1);
    EXPECT_ERROR(open_ros1_bag(memory_source(bag.bytes)), format("chunk at byte {}: ", bag.chunk));
  }
}

TEST(Ros1Truncated, AChunkThatAnIndexNamesHasToBeWhole) {
  for (const std::string compression : {"bz2", "lz4"}) {
    const std::string records = connection_record(0, "/notes", "std_msgs/String");
    const std::string message = message_record({0, {5}, "a note"});
    const std::size_t chunk_at = test::ros1::kMagic.size() + bag_header(0, 0, 0).size();
    std::string entry;
    append_little_endian(entry, std::uint64_t{5} << 32U);
    append_little_endian(entry, static_cast<std::uint32_t>(records.size()));
    // Its data are missing; the bytes behind it belong to other records.
    const std::string chunk = chunk_record(compression, records.size() + message.size(), "") +
                              index_record(0, 1, entry) + compressed_as(compression, records + message);
    const std::string bytes = std::string(test::ros1::kMagic) + bag_header(chunk_at + chunk.size(), 1, 1) +
                              chunk + records + chunk_info_record(chunk_at, 0, 1);
    const Bag bag = open_ros1_bag(memory_source(bytes)).value();
    ASSERT_EQ(bag.messages.size(), 1U);
    EXPECT_TRUE(bag.warnings.empty());
    EXPECT_ERROR(bag.read(bag.messages[0]), format("chunk at byte {}: ", chunk_at));
  }
}

TEST(Ros1Truncated, OfAChunkWhoseSizeIsNotStatedSomeMegabytesAreRead) {
  std::string records = connection_record(0, "/notes", "std_msgs/String");
  records += message_record({0, {1}, "small"});
  records += message_record({0, {2}, std::string(std::size_t{1} << 25U, 'x')});
  const std::string bytes = bag_of_one_chunk("lz4", records, false).bytes;
  const Bag bag = open_ros1_bag(memory_source(bytes)).value();
  ASSERT_EQ(bag.messages.size(), 1U) << "the second one alone has as many bytes as are read";
  EXPECT_EQ(bag.read(bag.messages[0]), "small");
}

}  // namespace
}  // namespace adit

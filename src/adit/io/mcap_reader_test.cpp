// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/mcap_reader.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "adit/core/format.hpp"
#include "adit/core/rng.hpp"
#include "adit/io/bag.hpp"
#include "adit/io/compression.hpp"
#include "adit/io/crc32.hpp"
#include "adit/io/tum.hpp"
#include "support/files.hpp"
#include "support/foreign_mcap.hpp"

namespace adit {
namespace {

using mcap::Opcode;

const std::string kSchema =
    mcap::framed(Opcode::schema, mcap::encode(mcap::Schema{1, std::string(ros::kOdometry), "ros2msg", ""}));
const std::string kChannel =
    mcap::framed(Opcode::channel, mcap::encode(mcap::Channel{1, 1, "/odom", "cdr", {}}));

/// A file whose summary has faults.
struct Faults {
  bool lacks_schemas = false;
  int chunk_named = 1;               ///< So often.
  int metadata_named = 1;            ///< So often.
  std::uint64_t metadata_moved = 0;  ///< Bytes behind where it is.
  std::uint64_t index_time = 1000;   ///< Of the first message, as the message index has it.
  bool is_crc_wrong = false;         ///< Of the summary.
  bool is_chunk_damaged = false;     ///< In the data section.
};

/// Two messages in a chunk with its index, a record of metadata, and the summary.
std::string indexed_file(const Faults& faults = {}) {
  std::string records = kSchema + kChannel;
  mcap::MessageIndex index{1, {}};
  for (std::int64_t m = 0; m < 2; ++m) {
    const Stamp time{1000 + m};
    index.entries.emplace_back(m == 0 ? faults.index_time : 1001, records.size());
    records +=
        mcap::framed(Opcode::message, mcap::encode(mcap::Message{1, 0, time, time, format("message {}", m)}));
  }
  std::string bytes(mcap::kMagic);
  bytes += mcap::framed(Opcode::header, mcap::encode(mcap::Header{"ros2", "hand"}));
  mcap::ChunkIndex in_summary{{1000}, {1001}, bytes.size(), 0, {}, 0, "", records.size(), records.size()};
  const std::uint32_t crc = crc32(records) + (faults.is_chunk_damaged ? 1U : 0U);
  bytes += mcap::framed(Opcode::chunk,
                        mcap::encode(mcap::Chunk{{1000}, {1001}, records.size(), crc, "", records}));
  in_summary.chunk_length = bytes.size() - in_summary.chunk_start;
  bytes += mcap::framed(Opcode::message_index, mcap::encode(index));
  in_summary.message_index_length = bytes.size() - in_summary.chunk_start - in_summary.chunk_length;
  const std::uint64_t metadata_at = bytes.size();
  bytes += mcap::framed(Opcode::metadata, mcap::encode(mcap::Metadata{"adit", {{"robot", "a"}}}));
  const mcap::MetadataIndex of_metadata{metadata_at + faults.metadata_moved, bytes.size() - metadata_at,
                                        "adit"};
  bytes += mcap::framed(Opcode::data_end, std::string(4, '\0'));
  mcap::Footer footer{bytes.size(), 0, 0};
  std::string summary = (faults.lacks_schemas ? "" : kSchema) + kChannel;
  for (int i = 0; i < faults.chunk_named; ++i)
    summary += mcap::framed(Opcode::chunk_index, mcap::encode(in_summary));
  for (int i = 0; i < faults.metadata_named; ++i)
    summary += mcap::framed(Opcode::metadata_index, mcap::encode(of_metadata));
  const std::string covered = summary + mcap::framed(Opcode::footer, mcap::encode(footer));
  footer.summary_crc =
      crc32(std::string_view(covered).substr(0, covered.size() - 4)) + (faults.is_crc_wrong ? 1U : 0U);
  return bytes + summary + mcap::framed(Opcode::footer, mcap::encode(footer)) + std::string(mcap::kMagic);
}

void expect_both_messages(const Result<Bag>& bag) {
  ASSERT_TRUE(bag) << bag.error().message;
  ASSERT_EQ(bag->messages.size(), 2U);
  ASSERT_EQ(bag->topics.size(), 1U);
  EXPECT_EQ(bag->topics[0].type, ros::kOdometry);
  for (std::size_t m = 0; m < 2; ++m) {
    EXPECT_EQ(bag->messages[m].log_time.ns, 1000 + static_cast<std::int64_t>(m));
    EXPECT_EQ(bag->read(bag->messages[m]).value(), format("message {}", m));
  }
  EXPECT_EQ(bag->own, (std::map<std::string, std::string>{{"robot", "a"}}));
}

TEST(McapReader, ASummaryThatLeavesOutSchemasIsFilledUpFromTheData) {
  const Result<Bag> whole = open_mcap_bag(memory_source(indexed_file()));
  expect_both_messages(whole);
  EXPECT_TRUE(whole->warnings.empty());
  const Result<Bag> without = open_mcap_bag(memory_source(indexed_file({.lacks_schemas = true})));
  expect_both_messages(without);
  EXPECT_TRUE(without->warnings.empty()) << "the specification allows it";
}

TEST(McapReader, WhereTheSummaryIsDamagedTheDataAreGoneThrough) {
  const std::uint64_t late = static_cast<std::uint64_t>(INT64_MAX) + 1;
  const std::vector<std::pair<Faults, std::string>> cases = {
      {{.is_crc_wrong = true}, "the checksum of the summary does not fit"},
      {{.metadata_moved = 3}, "reaches past the end of the file"},
      {{.chunk_named = 2}, "the summary names a chunk twice"},
      {{.chunk_named = 10'000}, "the summary names a chunk twice"},
      {{.metadata_named = 2}, "the index names this record twice"},
      {{.index_time = late}, "a message index has the time 9223372036854775808 ns"}};
  for (const auto& [faults, fault] : cases) {
    const Result<Bag> bag = open_mcap_bag(memory_source(indexed_file(faults)));
    expect_both_messages(bag);
    ASSERT_EQ(bag->warnings.size(), 1U) << fault;
    EXPECT_NE(bag->warnings[0].find(fault), std::string::npos) << bag->warnings[0];
    EXPECT_NE(bag->warnings[0].find("its 2 messages are read"), std::string::npos) << bag->warnings[0];
  }
  EXPECT_ERROR(open_mcap_bag(memory_source(indexed_file({.is_crc_wrong = true, .is_chunk_damaged = true}))),
               "its index cannot be used either (byte");
}

TEST(McapReader, NoFlippedByteBehindTheDataCostsAMessage) {
  const std::string bytes = indexed_file();
  const std::string end_of_data = mcap::framed(Opcode::data_end, std::string(4, '\0'));
  const std::size_t summary = bytes.find(end_of_data) + end_of_data.size();
  for (std::size_t at = summary; at < bytes.size(); ++at) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(~damaged[at]);
    const Result<Bag> bag = open_mcap_bag(memory_source(damaged));
    ASSERT_NO_FATAL_FAILURE(expect_both_messages(bag)) << "byte " << at;
    EXPECT_EQ(bag->warnings.size(), 1U) << "byte " << at;
  }
}

TEST(McapReader, AttachmentsAreSteppedOverUnread) {
  const auto attachment = static_cast<Opcode>(0x09);
  const std::string message = mcap::framed(Opcode::message, mcap::encode(mcap::Message{1, 0, {5}, {5}, "x"}));
  const auto bytes = std::make_shared<const std::string>(
      test::plain_file({kSchema, kChannel, mcap::framed(attachment, std::string(100'000, 'a')), message}));
  ByteSource source = memory_source(bytes);
  const auto most = std::make_shared<std::uint64_t>(0);
  source.read = [most, read = source.read](std::uint64_t offset, std::uint64_t size) {
    *most = std::max(*most, size);
    return read(offset, size);
  };
  const Result<Bag> bag = open_mcap_bag(source);
  ASSERT_TRUE(bag) << bag.error().message;
  EXPECT_EQ(bag->messages.size(), 1U);
  EXPECT_LT(*most, 1000U);
  const std::size_t inside = bytes->find("aaa") + 100;
  EXPECT_ERROR(open_mcap_bag(memory_source(bytes->substr(0, inside))),
               "a record of 100000 bytes reaches past the end of the file");
}

/// A frame of LZ4 with its blocks as they are, which it allows for what does not shrink.
std::string stored_in_lz4(std::string_view bytes) {
  constexpr std::size_t kBlock = std::size_t{64} << 10U;  // the most, by the frame's head
  constexpr std::uint32_t kStored = 1U << 31U;
  std::string frame("\x04\x22\x4d\x18\x60\x40\x82", 7);
  for (std::size_t at = 0; at < bytes.size(); at += kBlock) {
    const std::string_view block = bytes.substr(at, kBlock);
    const std::uint32_t head = kStored | static_cast<std::uint32_t>(block.size());
    for (unsigned shift = 0; shift < 32; shift += 8) frame += static_cast<char>((head >> shift) & 0xFFU);
    frame += block;
  }
  return frame + std::string(4, '\0');
}

std::string compressed(const std::string& bytes, const std::string& compression) {
  if (compression == "zstd") return compress_zstd(bytes);
  return compression == "lz4" ? stored_in_lz4(bytes) : bytes;
}

/// A chunk of `num` messages of a kilobyte, packed as `compression` says.
std::string file_of_one_chunk(std::size_t num, const std::string& compression) {
  std::string records = kSchema + kChannel;
  Rng rng(1);
  for (std::size_t m = 0; m < num; ++m) {
    const Stamp time{static_cast<std::int64_t>(m)};
    std::string data = format("message {} ", m);
    while (data.size() < 1000) data += static_cast<char>(rng.uniform(0.0, 256.0));
    records += mcap::framed(Opcode::message, mcap::encode(mcap::Message{1, 0, time, time, data}));
  }
  const std::string packed = compressed(records, compression);
  return test::plain_file({mcap::framed(
      Opcode::chunk,
      mcap::encode(mcap::Chunk{
          {0}, {static_cast<std::int64_t>(num)}, records.size(), crc32(records), compression, packed}))});
}

TEST(McapReader, OfAChunkThatIsCutWhatLiesInFrontOfTheCutIsRead) {
  constexpr std::size_t kNum = 600;
  for (const std::string compression : {"", "zstd", "lz4"}) {
    const std::string whole = file_of_one_chunk(kNum, compression);
    ASSERT_EQ(open_mcap_bag(memory_source(whole))->messages.size(), kNum);
    for (const double share : {0.3, 0.5, 0.9}) {
      const auto size = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
      const Result<Bag> cut = open_mcap_bag(memory_source(whole.substr(0, size)));
      ASSERT_TRUE(cut) << cut.error().message;
      // zstd packs 128 kB at a time, LZ4 64 kB here.
      EXPECT_GT(cut->messages.size() + (compression.empty() ? 2U : 130U),
                static_cast<std::size_t>(share * kNum))
          << compression;
      for (std::size_t m = 0; m < cut->messages.size(); ++m)
        ASSERT_TRUE(cut->read(cut->messages[m])->starts_with(format("message {} ", m)));
      ASSERT_EQ(cut->warnings.size(), 1U);
      EXPECT_NE(cut->warnings[0].find(format("{} messages", cut->messages.size())), std::string::npos)
          << cut->warnings[0];
      EXPECT_NE(cut->warnings[0].find("those of the chunk that is cut not verified"), std::string::npos)
          << cut->warnings[0];
      // As a loss of power leaves it, zeros for data.
      const Result<Bag> zeros = open_mcap_bag(memory_source(whole.substr(0, size) + std::string(4096, '\0')));
      ASSERT_TRUE(zeros) << zeros.error().message;
      EXPECT_EQ(zeros->messages.size(), cut->messages.size()) << compression;
    }
  }
}

TEST(McapReader, WhatACutChunkCannotSayCostsNothingInFrontOfIt) {
  const std::string message = mcap::framed(Opcode::message, mcap::encode(mcap::Message{1, 0, {5}, {5}, "x"}));
  const std::string stray = mcap::framed(Opcode::message, mcap::encode(mcap::Message{7, 0, {6}, {6}, "y"}));
  const std::string damaged = mcap::framed(Opcode::message, "short");
  for (const auto& [compression, records] : {std::pair<std::string, std::string>{"", stray},
                                             {"", message + damaged},
                                             {"zstd", "no frame of zstd"},
                                             {"lz4", "no frame of LZ4"},
                                             {"unheard of", stray}}) {
    const std::string chunk = mcap::framed(
        Opcode::chunk,
        mcap::encode(mcap::Chunk{{5}, {6}, 1000, 0, compression, records + std::string(1000, ' ')}));
    const std::string file = test::plain_file({kSchema, kChannel, message, chunk});
    const Result<Bag> bag = open_mcap_bag(memory_source(file.substr(0, file.find(records) + records.size())));
    ASSERT_TRUE(bag) << bag.error().message;
    ASSERT_EQ(bag->messages.size(), 1U) << compression;
    EXPECT_EQ(bag->read(bag->messages[0]).value(), "x");
  }
}

TEST(McapReader, LogTimesStayWithinWhatDifferencesCanHold) {
  const std::string sound = mcap::framed(Opcode::message, mcap::encode(mcap::Message{1, 0, {}, {5}, "x"}));
  constexpr std::size_t kLogTime = 15;  // behind opcode, length, channel and number
  for (const std::string& time : {std::string("\xff\xff\xff\xff\xff\xff\xff\x7f"), std::string(8, '\xff')}) {
    const std::string message = std::string(sound).replace(kLogTime, time.size(), time);
    const Result<Bag> bag = open_mcap_bag(memory_source(test::plain_file({kSchema, kChannel, message})));
    ASSERT_TRUE(bag) << bag.error().message;
    EXPECT_EQ(bag->messages.at(0).log_time, kLargestStamp);
    EXPECT_EQ(bag->read(bag->messages[0]).value(), "x");
  }
}

}  // namespace
}  // namespace adit

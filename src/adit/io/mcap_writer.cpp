// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/mcap_writer.hpp"

#include <algorithm>

#include "adit/core/check.hpp"
#include "adit/io/compression.hpp"
#include "adit/io/crc32.hpp"
#include "adit/io/packed_cloud.hpp"

namespace adit::mcap {
namespace {

/// A chunk under construction: its uncompressed records and where each message lies in them.
struct ChunkContent {
  std::string records;
  std::map<std::uint16_t, MessageIndex> indexes;
  Stamp start;
  Stamp end;
};

ChunkContent pack(const std::vector<Message>& messages) {
  ChunkContent content;
  const auto [first, last] = std::ranges::minmax(messages, {}, &Message::log_time);
  content.start = first.log_time;
  content.end = last.log_time;
  for (const Message& message : messages) {
    MessageIndex& index = content.indexes[message.channel_id];
    index.channel_id = message.channel_id;
    index.entries.emplace_back(message.log_time.ns, content.records.size());
    content.records += framed(Opcode::message, encode(message));
  }
  return content;
}

template <class Record>
std::vector<std::string> encode_all(const std::vector<Record>& records) {
  std::vector<std::string> contents;
  for (const Record& record : records) contents.push_back(encode(record));
  return contents;
}

}  // namespace

Writer::Writer(std::ostream& out, const Header& header) : out_(out) {
  write(kMagic);
  write(framed(Opcode::header, encode(header)));
}

std::uint16_t Writer::add_schema(const std::string& name, const std::string& encoding,
                                 const std::string& data) {
  // Id 0 means "no schema".
  schemas_.push_back({static_cast<std::uint16_t>(schemas_.size() + 1), name, encoding, data});
  write(framed(Opcode::schema, encode(schemas_.back())));
  return schemas_.back().id;
}

std::uint16_t Writer::add_channel(const std::string& topic, const std::string& message_encoding,
                                  std::uint16_t schema_id) {
  channels_.push_back({static_cast<std::uint16_t>(channels_.size()), schema_id, topic, message_encoding, {}});
  write(framed(Opcode::channel, encode(channels_.back())));
  return channels_.back().id;
}

void Writer::write_chunk(const std::vector<Message>& messages) {
  ADIT_CHECK(!messages.empty(), "a chunk holds a message or more");
  const ChunkContent content = pack(messages);
  const std::string records = compress_zstd(content.records);
  const Chunk chunk{content.start,          content.end, content.records.size(),
                    crc32(content.records), "zstd",      records};
  ChunkIndex index{chunk.start,
                   chunk.end,
                   offset_,
                   0,
                   {},
                   0,
                   chunk.compression,
                   chunk.records.size(),
                   chunk.uncompressed_size};
  write(framed(Opcode::chunk, encode(chunk)));
  index.chunk_length = offset_ - index.chunk_start;
  for (const auto& [channel, message_index] : content.indexes) {
    index.message_index_offsets[channel] = offset_;
    write(framed(Opcode::message_index, encode(message_index)));
    statistics_.channel_message_counts[channel] += message_index.entries.size();
  }
  index.message_index_length = offset_ - index.chunk_start - index.chunk_length;
  const bool is_first = statistics_.message_count == 0;
  statistics_.start = is_first ? index.start : std::min(statistics_.start, index.start);
  statistics_.end = is_first ? index.end : std::max(statistics_.end, index.end);
  statistics_.message_count += messages.size();
  chunks_.push_back(std::move(index));
}

void Writer::write_metadata(const Metadata& metadata) {
  const std::string record = framed(Opcode::metadata, encode(metadata));
  metadata_.push_back({offset_, record.size(), metadata.name});
  write(record);
}

void Writer::finish() {
  std::string data_crc;
  append_little_endian(data_crc, crc_);
  write(framed(Opcode::data_end, data_crc));
  crc_ = 0;
  statistics_.schema_count = static_cast<std::uint16_t>(schemas_.size());
  statistics_.channel_count = static_cast<std::uint32_t>(channels_.size());
  statistics_.metadata_count = static_cast<std::uint32_t>(metadata_.size());
  statistics_.chunk_count = static_cast<std::uint32_t>(chunks_.size());
  Footer footer;
  footer.summary_start = offset_;
  std::vector<SummaryOffset> groups;
  write_group(Opcode::schema, encode_all(schemas_), groups);
  write_group(Opcode::channel, encode_all(channels_), groups);
  write_group(Opcode::statistics, {encode(statistics_)}, groups);
  write_group(Opcode::metadata_index, encode_all(metadata_), groups);
  write_group(Opcode::chunk_index, encode_all(chunks_), groups);
  footer.summary_offset_start = offset_;
  for (const SummaryOffset& group : groups) write(framed(Opcode::summary_offset, encode(group)));
  // The checksum covers the footer up to the checksum itself.
  const std::string head = framed(Opcode::footer, encode(footer));
  footer.summary_crc =
      crc32(std::string_view(head).substr(0, head.size() - sizeof(footer.summary_crc)), crc_);
  write(framed(Opcode::footer, encode(footer)));
  write(kMagic);
  out_.flush();
}

void Writer::write(std::string_view bytes) {
  out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  offset_ += bytes.size();
  crc_ = crc32(bytes, crc_);
}

void Writer::write_group(Opcode opcode, const std::vector<std::string>& records,
                         std::vector<SummaryOffset>& groups) {
  if (records.empty()) return;
  const std::uint64_t start = offset_;
  for (const std::string& record : records) write(framed(opcode, record));
  groups.push_back({opcode, start, offset_ - start});
}

}  // namespace adit::mcap

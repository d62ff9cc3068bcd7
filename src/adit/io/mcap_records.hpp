// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The records of an MCAP file and their bytes. Source: the MCAP specification, version 0
/// (https://mcap.dev/spec). A file is: magic, records, magic. A record is: opcode (1 byte), length (8 bytes),
/// content; little-endian throughout.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/core/time.hpp"

namespace adit::mcap {

inline constexpr std::string_view kMagic{"\x89MCAP0\r\n", 8};  ///< At both ends of a file.
inline constexpr std::uint64_t kRecordHead = 9;                ///< Opcode and length.

/// The kinds of records that adit knows. Others, such as attachments, are stepped over.
enum class Opcode : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F,
};

/// The first record of a file.
struct Header {
  std::string profile;  ///< What the messages keep to: "ros2"; "" for nothing known.
  std::string library;  ///< The program that wrote the file.
};

/// The last record of a file: where its summary is.
struct Footer {
  std::uint64_t summary_start = 0;         ///< 0: the file has no summary.
  std::uint64_t summary_offset_start = 0;  ///< Of the first SummaryOffset; 0: there is none.
  std::uint32_t summary_crc = 0;           ///< 0: not stated.
};
/// Of the whole record, with its head.
inline constexpr std::uint64_t kFooterSize = kRecordHead + 20;

/// A message type.
struct Schema {
  std::uint16_t id = 0;  ///< Not 0.
  std::string name;      ///< The type: "sensor_msgs/msg/Imu".
  std::string encoding;  ///< Of `data`; "ros2msg" for definitions of ROS 2.
  std::string data;      ///< The definition, with those of the types in it.
};

/// A topic with messages of one type.
struct Channel {
  std::uint16_t id = 0;                         ///< What messages refer to.
  std::uint16_t schema_id = 0;                  ///< 0: none.
  std::string topic;                            ///< As in BagTopic::name.
  std::string message_encoding;                 ///< As in BagTopic::encoding.
  std::map<std::string, std::string> metadata;  ///< For anything; adit writes none.
};

/// One message of a channel.
struct Message {
  std::uint16_t channel_id = 0;  ///< Of a channel that stands before it in the file.
  std::uint32_t sequence = 0;    ///< Counts the messages of the channel, where the writer does; else 0.
  Stamp log_time;                ///< When it was recorded.
  Stamp publish_time;            ///< When it was sent.
  std::string data;              ///< In the channel's encoding.
};

/// Records that are compressed together.
struct Chunk {
  /// Log times of its earliest and its latest message.
  ///@{
  Stamp start;
  Stamp end;
  ///@}
  std::uint64_t uncompressed_size = 0;  ///< Of the records, bytes.
  std::uint32_t uncompressed_crc = 0;   ///< 0: not stated.
  std::string compression;              ///< "lz4", "zstd", or "" for none.
  std::string_view records;  ///< Compressed: schemas, channels and messages. Bytes of somebody else.
};

/// Where the messages of one channel lie in the uncompressed records of the chunk before.
struct MessageIndex {
  std::uint16_t channel_id = 0;                                  ///< Each channel has an index of its own.
  std::vector<std::pair<std::uint64_t, std::uint64_t>> entries;  ///< Log time and offset.
};

/// What a summary says of a chunk.
struct ChunkIndex {
  /// As in Chunk.
  ///@{
  Stamp start;
  Stamp end;
  ///@}
  std::uint64_t chunk_start = 0;                                 ///< Offset of the chunk record in the file.
  std::uint64_t chunk_length = 0;                                ///< Of the record with its head.
  std::map<std::uint16_t, std::uint64_t> message_index_offsets;  ///< By channel.
  /// Of all MessageIndex records, which follow the chunk; 0: there are none.
  std::uint64_t message_index_length = 0;
  std::string compression;              ///< As in Chunk.
  std::uint64_t compressed_size = 0;    ///< Of the records as they stand in the chunk, bytes.
  std::uint64_t uncompressed_size = 0;  ///< As in Chunk.
};

/// Counts of a whole file, in its summary. adit writes them, and reads files without them.
struct Statistics {
  /// Records of each kind in the whole file.
  ///@{
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0;
  std::uint32_t attachment_count = 0;
  std::uint32_t metadata_count = 0;
  std::uint32_t chunk_count = 0;
  ///@}
  /// Log times of the earliest and the latest message; 0 without messages.
  ///@{
  Stamp start;
  Stamp end;
  ///@}
  std::map<std::uint16_t, std::uint64_t> channel_message_counts;  ///< By channel id.
};

/// Texts by key, under a name.
struct Metadata {
  std::string name;                            ///< "adit" in recordings that adit wrote.
  std::map<std::string, std::string> entries;  ///< In any order in the file.
};

/// Where a Metadata record lies.
struct MetadataIndex {
  std::uint64_t offset = 0;  ///< Of its head, in the file.
  std::uint64_t length = 0;  ///< With its head.
  std::string name;          ///< As in the record.
};

/// Where in the summary the records of one kind lie, side by side.
struct SummaryOffset {
  Opcode group = Opcode::schema;  ///< That kind.
  std::uint64_t start = 0;        ///< In the file.
  std::uint64_t length = 0;       ///< Of all of them, bytes.
};

/// Calls `visit(a, b, ...)` with the fields in file order; encoder and decoder share this one description.
///@{
template <class Visit>
void visit_fields(Header& r, Visit&& visit) {
  visit(r.profile, r.library);
}
template <class Visit>
void visit_fields(Footer& r, Visit&& visit) {
  visit(r.summary_start, r.summary_offset_start, r.summary_crc);
}
template <class Visit>
void visit_fields(Schema& r, Visit&& visit) {
  visit(r.id, r.name, r.encoding, r.data);
}
template <class Visit>
void visit_fields(Channel& r, Visit&& visit) {
  visit(r.id, r.schema_id, r.topic, r.message_encoding, r.metadata);
}
template <class Visit>
void visit_fields(MessageIndex& r, Visit&& visit) {
  visit(r.channel_id, r.entries);
}
template <class Visit>
void visit_fields(ChunkIndex& r, Visit&& visit) {
  visit(r.start, r.end, r.chunk_start, r.chunk_length, r.message_index_offsets, r.message_index_length,
        r.compression, r.compressed_size, r.uncompressed_size);
}
template <class Visit>
void visit_fields(Statistics& r, Visit&& visit) {
  visit(r.message_count, r.schema_count, r.channel_count, r.attachment_count, r.metadata_count, r.chunk_count,
        r.start, r.end, r.channel_message_counts);
}
template <class Visit>
void visit_fields(Metadata& r, Visit&& visit) {
  visit(r.name, r.entries);
}
template <class Visit>
void visit_fields(MetadataIndex& r, Visit&& visit) {
  visit(r.offset, r.length, r.name);
}
template <class Visit>
void visit_fields(SummaryOffset& r, Visit&& visit) {
  visit(r.group, r.start, r.length);
}
///@}

/// The content of a record as bytes, without its head. Stamps must not be negative.
///@{
template <class Record>
[[nodiscard]] std::string encode(Record record);
[[nodiscard]] std::string encode(const Message& message);
[[nodiscard]] std::string encode(const Chunk& chunk);
///@}
/// Head and content.
[[nodiscard]] std::string framed(Opcode opcode, std::string_view content);

/// Nothing when the content is too short or its lengths do not fit. Bytes behind the known fields are left
/// alone, as the specification demands.
///@{
template <class Record>
[[nodiscard]] std::optional<Record> decode(std::string_view content);
template <>
[[nodiscard]] std::optional<Message> decode<Message>(std::string_view content);
template <>
[[nodiscard]] std::optional<Chunk> decode<Chunk>(std::string_view content);
///@}
/// As decode<Chunk>, but where the records are cut off, with those bytes of them that are there.
[[nodiscard]] std::optional<Chunk> decode_cut_chunk(std::string_view content);

/// A record in memory.
struct RecordView {
  Opcode opcode = Opcode::header;  ///< Not always one of the enumerators.
  std::uint64_t offset = 0;        ///< Of the head.
  std::string_view content;        ///< Without the head; part of the bytes that were stepped through.
};
/// Steps through whole records in memory; stops at the end or in front of a record that is cut off.
class RecordCursor {
 public:
  /// `bytes` must outlive the cursor and the records that it returns.
  explicit RecordCursor(std::string_view bytes) : bytes_(bytes) {}
  /// None where it stops.
  std::optional<RecordView> next();
  /// How far whole records reach.
  [[nodiscard]] std::uint64_t offset() const { return offset_; }

 private:
  std::string_view bytes_;
  std::uint64_t offset_ = 0;
};

}  // namespace adit::mcap

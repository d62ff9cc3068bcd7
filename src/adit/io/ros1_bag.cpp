// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/ros1_bag.hpp"

#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/io/compression.hpp"
#include "adit/io/distinct_parts.hpp"
#include "adit/io/recent_chunks.hpp"

namespace adit {
namespace ros1 {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
constexpr std::string_view kCopyAgain =
    "copy it again from where it was recorded, as nothing can be read of this one";
constexpr std::string_view kCopyOnceDone =
    "nothing can be read of this one; if its recorder still ran, copy it again once that has ended";

/// Values of the field "op".
enum class Op : std::uint8_t {
  message = 2,
  bag_header = 3,
  index = 4,
  chunk = 5,
  chunk_info = 6,
  connection = 7
};

tl::unexpected<Error> fail_at(std::uint64_t offset, std::string_view message) {
  return fail(format("byte {}: {}", offset, message));
}

template <class T>
T little_endian(std::string_view bytes) {
  T value{};
  std::memcpy(&value, bytes.data(), sizeof(T));  // all machines that adit runs on are little-endian
  return value;
}

/// The fields of a record's header: "name=value", each behind its length.
using HeaderFields = std::map<std::string, std::string, std::less<>>;

std::optional<HeaderFields> fields_in(std::string_view header) {
  HeaderFields fields;
  while (!header.empty()) {
    if (header.size() < 4) return std::nullopt;
    const std::size_t size = little_endian<std::uint32_t>(header);
    header.remove_prefix(4);
    if (size > header.size()) return std::nullopt;
    const std::string_view field = header.substr(0, size);
    const std::size_t equals = field.find('=');
    if (equals == std::string_view::npos) return std::nullopt;
    fields.emplace(field.substr(0, equals), field.substr(equals + 1));
    header.remove_prefix(size);
  }
  return fields;
}

template <class T>
std::optional<T> number_in(const HeaderFields& fields, std::string_view name) {
  const auto found = fields.find(name);
  if (found == fields.end() || found->second.size() != sizeof(T)) return std::nullopt;
  return little_endian<T>(found->second);
}

std::string text_in(const HeaderFields& fields, std::string_view name) {
  const auto found = fields.find(name);
  return found == fields.end() ? std::string() : found->second;
}

/// Seconds, then nanoseconds.
Stamp stamp_of(std::uint64_t time) {
  return {static_cast<std::int64_t>(time & 0xFFFFFFFFU) * kNanosecondsPerSecond +
          static_cast<std::int64_t>(time >> 32U)};
}

/// A record without its data.
struct Record {
  std::uint64_t offset = 0;
  Op op{};
  HeaderFields fields;
  std::uint64_t data = 0;  ///< Offset.
  std::uint32_t size = 0;  ///< Of the data.
  [[nodiscard]] std::uint64_t end() const { return data + size; }
};

/// Without a look at whether its data are there.
Result<Record> read_head(const ByteSource& source, std::uint64_t offset) {
  const auto length_at = [&](std::uint64_t at) {
    return source.read(at, 4).map(
        [](const std::string& bytes) { return little_endian<std::uint32_t>(bytes); });
  };
  Record record;
  record.offset = offset;
  const Result<std::uint32_t> header_size = length_at(offset);
  if (!header_size) return tl::unexpected(header_size.error());
  const Result<std::string> header = source.read(offset + 4, *header_size);
  if (!header) return tl::unexpected(header.error());
  std::optional<HeaderFields> fields = fields_in(*header);
  const std::optional<std::uint8_t> op = fields ? number_in<std::uint8_t>(*fields, "op") : std::nullopt;
  if (!op) return fail_at(offset, "no record of a ROS 1 bag");
  const Result<std::uint32_t> size = length_at(offset + 4 + *header_size);
  if (!size) return tl::unexpected(size.error());
  record.op = static_cast<Op>(*op);
  record.fields = std::move(*fields);
  record.data = offset + 8 + *header_size;
  record.size = *size;
  return record;
}

tl::unexpected<Error> fail_past_end(std::uint64_t offset) {
  return fail_at(offset, "a record reaches past the end of the file");
}

Result<Record> read_record(const ByteSource& source, std::uint64_t offset) {
  Result<Record> record = read_head(source, offset);
  if (record && record->end() > source.size) return fail_past_end(offset);
  return record;
}

/// "sensor_msgs/PointCloud2" as ROS 2 calls it.
std::string type_in_ros2(const std::string& type) {
  if (type == "tf/tfMessage") return "tf2_msgs/msg/TFMessage";
  const std::size_t slash = type.find('/');
  return slash == std::string::npos ? type : type.substr(0, slash) + "/msg" + type.substr(slash);
}

/// A message lies in a chunk, behind `offset` of its expanded records, or in the file itself.
struct Place {
  std::optional<std::size_t> chunk;  ///< Index into the chunks.
  std::uint64_t offset = 0;
};

struct Contents {
  Bag bag;  ///< Without `read`.
  TopicIndex topics;
  std::map<std::uint32_t, std::size_t> topic_of_connection;
  std::vector<std::uint64_t> chunks;  ///< Offsets of their records.
  std::optional<Record> truncated;    ///< The compressed chunk that the file ends in.
  std::vector<Place> places;          ///< BagMessage::where counts these.

  [[nodiscard]] Result<> add_message(std::uint32_t connection, Stamp time, Place place) {
    const auto topic = topic_of_connection.find(connection);
    if (topic == topic_of_connection.end())
      return fail(format("a message is of connection {}, which is not defined", connection));
    bag.messages.push_back({topic->second, time, places.size()});
    places.push_back(place);
    return {};
  }
  [[nodiscard]] Result<> add_connection(const HeaderFields& head, std::string_view data,
                                        std::uint64_t offset) {
    const auto id = number_in<std::uint32_t>(head, "conn");
    const std::optional<HeaderFields> fields = fields_in(data);
    if (!id || !fields) return fail_at(offset, "damaged connection record");
    const BagTopic topic{text_in(head, "topic"), type_in_ros2(text_in(*fields, "type")), "ros1"};
    topic_of_connection[*id] = topics.of(topic, bag.topics);
    return {};
  }
};

/// "" for none.
std::string compression_of(const Record& chunk) {
  const std::string compression = text_in(chunk.fields, "compression");
  return compression == "none" ? "" : compression;
}

/// A recorder writes the size of a chunk's data when it is done with it, and leaves 0 where it is killed.
bool is_unfinished(const Record& chunk) { return chunk.size == 0; }

/// Whether the file ends in the data of this compressed chunk. Asked only where a file is gone through: what
/// an index names has to be whole.
bool is_truncated_and_compressed(const ByteSource& source, const Record& chunk) {
  return chunk.op == Op::chunk && !compression_of(chunk).empty() &&
         (chunk.end() > source.size || is_unfinished(chunk));
}

/// The front of the records of such a chunk.
Result<std::string> read_truncated_chunk(const ByteSource& source, const Record& chunk) {
  constexpr std::uint64_t kMost = std::uint64_t{1} << 28U;          // of a damaged size, too
  constexpr std::uint64_t kMostUnstated = std::uint64_t{1} << 25U;  // chunks are of 768 kB, or one message
  const std::uint64_t most = is_unfinished(chunk) ? kMostUnstated : kMost;
  const std::uint64_t stated = number_in<std::uint32_t>(chunk.fields, "size").value_or(0);
  return source.read(chunk.data, std::min(source.size - chunk.data, most)).map([&](const std::string& bytes) {
    return decompress_front(bytes, compression_of(chunk),
                            is_unfinished(chunk) ? most : std::min(stated, most));
  });
}

/// The expanded records of a chunk.
Result<std::string> read_chunk(const ByteSource& source, std::uint64_t offset) {
  const Result<Record> record = read_record(source, offset);
  if (!record) return tl::unexpected(record.error());
  const auto size = number_in<std::uint32_t>(record->fields, "size");
  if (record->op != Op::chunk || !size) return fail_at(offset, "no chunk where the index announces one");
  Result<std::string> expanded =
      source.read(record->data, record->size).and_then([&](const std::string& bytes) {
        return decompress(bytes, compression_of(*record), *size);
      });
  if (!expanded) return fail(format("chunk at byte {}", offset), expanded.error());
  return expanded;
}

Result<> add_message_record(const Record& record, Contents& contents, Place place) {
  const auto connection = number_in<std::uint32_t>(record.fields, "conn");
  const auto time = number_in<std::uint64_t>(record.fields, "time");
  if (!connection || !time) return fail_at(record.offset, "damaged message record");
  return contents.add_message(*connection, stamp_of(*time), place);
}

Result<> add_connection_record(const ByteSource& source, const Record& record, Contents& contents) {
  return source.read(record.data, record.size).and_then([&](const std::string& data) {
    return contents.add_connection(record.fields, data, record.offset);
  });
}

/// Connections and messages of a chunk without index; `records`: the expanded ones.
Result<> scan_chunk(Result<std::string> records, std::uint64_t offset, Contents& contents) {
  if (!records) return tl::unexpected(records.error());
  const std::size_t chunk = contents.chunks.size();
  contents.chunks.push_back(offset);
  const ByteSource inside = memory_source(std::move(*records));
  for (std::uint64_t at = 0; at < inside.size;) {
    const Result<Record> record = read_record(inside, at);
    if (!record) return fail(format("chunk at byte {}", offset), record.error());
    Result<> added;
    if (record->op == Op::connection) added = add_connection_record(inside, *record, contents);
    if (record->op == Op::message) added = add_message_record(*record, contents, {chunk, at});
    if (!added) return fail(format("chunk at byte {}", offset), added.error());
    at = record->end();
  }
  return {};
}

tl::unexpected<Error> fail_truncated(const Record& chunk) {
  return fail(format("the chunk at byte {} {}", chunk.offset,
                     is_unfinished(chunk) ? "is unfinished" : "reaches past the end of the file"));
}

/// Goes through the file from its start. What was read before an error stays in `contents`. Of a chunk that
/// is cut the records in front of the cut are taken; of a plain one as if they lay in the file itself.
Result<> scan_file(const ByteSource& source, Contents& contents) {
  std::optional<Record> cut_plain;
  for (std::uint64_t at = kMagic.size(); at < source.size;) {
    throw_if_cancelled();
    const Result<Record> record = read_head(source, at);
    if (!record) return tl::unexpected(record.error());
    if (is_truncated_and_compressed(source, *record)) {
      contents.truncated = *record;
      // That it ends inside of a record is known.
      (void)scan_chunk(read_truncated_chunk(source, *record), at, contents);
      return fail_truncated(*record);
    }
    if (record->end() > source.size) {
      if (record->op != Op::chunk || cut_plain) return fail_past_end(at);
      cut_plain = *record;
      at = record->data;
      continue;
    }
    Result<> added;
    if (record->op == Op::chunk) added = scan_chunk(read_chunk(source, at), at, contents);
    if (record->op == Op::connection) added = add_connection_record(source, *record, contents);
    if (record->op == Op::message) added = add_message_record(*record, contents, {std::nullopt, at});
    if (!added) return added;
    at = record->end();
  }
  return cut_plain ? fail_truncated(*cut_plain) : Result<>();
}

/// The messages of one chunk, from the index records behind it.
Result<> read_index(const ByteSource& source, std::uint64_t offset, std::uint32_t num_connections,
                    DistinctParts& parts, Contents& contents) {
  const Result<Record> chunk = read_record(source, offset);
  if (!chunk) return tl::unexpected(chunk.error());
  const std::size_t number = contents.chunks.size();
  contents.chunks.push_back(offset);
  std::uint64_t at = chunk->end();
  for (std::uint32_t i = 0; i < num_connections; ++i) {
    const Result<Record> index = read_record(source, at);
    if (!index) return tl::unexpected(index.error());
    const auto connection = number_in<std::uint32_t>(index->fields, "conn");
    if (index->op != Op::index || !connection) return fail_at(at, "no index where one is announced");
    const Result<std::string> entries = source.read(index->data, index->size);
    if (!entries) return tl::unexpected(entries.error());
    for (std::size_t e = 0; e + 12 <= entries->size(); e += 12) {
      const Stamp time = stamp_of(little_endian<std::uint64_t>(std::string_view(*entries).substr(e)));
      const auto inside = little_endian<std::uint32_t>(std::string_view(*entries).substr(e + 8));
      if (Result<> added = contents.add_message(*connection, time, {number, inside}); !added) return added;
    }
    at = index->end();
  }
  if (!parts.add(offset, at - offset))
    return fail_at(offset, "the index names a chunk twice, or chunks that overlap");
  return {};
}

/// Connections and chunks, which a whole file lists at its end. As many as its header says: a file that was
/// cut between two of these records looks whole but for that.
Result<> read_lists(const ByteSource& source, const Record& header, std::uint64_t index_at,
                    Contents& contents) {
  if (index_at > source.size) return fail_at(source.size, "the file ends in front of its index");
  std::uint32_t num_connections = 0;
  DistinctParts parts;
  for (std::uint64_t at = index_at; at < source.size;) {
    throw_if_cancelled();
    const Result<Record> record = read_record(source, at);
    if (!record) return tl::unexpected(record.error());
    Result<> taken;
    if (record->op == Op::connection) {
      taken = add_connection_record(source, *record, contents);
      ++num_connections;
    }
    if (record->op == Op::chunk_info) {
      const auto chunk = number_in<std::uint64_t>(record->fields, "chunk_pos");
      const auto count = number_in<std::uint32_t>(record->fields, "count");
      if (!chunk || !count) return fail_at(at, "damaged record of a chunk");
      taken = read_index(source, *chunk, *count, parts, contents);
    }
    if (!taken) return taken;
    at = record->end();
  }
  if (number_in<std::uint32_t>(header.fields, "conn_count") != num_connections ||
      number_in<std::uint32_t>(header.fields, "chunk_count") != contents.chunks.size())
    return fail_at(source.size, "the index has other numbers of connections and chunks than the header says");
  return {};
}

/// The error or, where messages could be read, the warning of a file that breaks off.
std::string torn_text(const Contents& contents, const std::string& fault) {
  const bool has_more = !contents.truncated || !is_unfinished(*contents.truncated);  // where it was recorded
  const std::size_t num_messages = contents.bag.messages.size();
  if (num_messages == 0)
    return format("the file breaks off before its first whole message: {}; {}", fault,
                  has_more ? kCopyAgain : kCopyOnceDone);
  const bool is_unverified = contents.truncated && compression_of(*contents.truncated) == "lz4";
  return format("the file breaks off: {}; the {} messages before the break are read{}{}", fault, num_messages,
                is_unverified ? ", those of that chunk not verified, as its checksum stands at its end" : "",
                has_more ? "; where the recording went on, copy the file again" : "");
}

Result<Contents> read_contents(const ByteSource& source) {
  const Result<std::string> magic = source.read(0, std::min<std::uint64_t>(source.size, kMagic.size()));
  if (!magic) return tl::unexpected(magic.error());
  if (*magic != kMagic) return fail("byte 0: not a bag of ROS 1 (format 2.0), or truncated");
  const Result<Record> header = read_record(source, kMagic.size());
  if (!header)
    return fail(format("the file breaks off in its header: {}; {}", header.error().message, kCopyAgain));
  // Where the recorder did not get to write the index, it is 0, or behind the cut.
  const std::uint64_t index_at = number_in<std::uint64_t>(header->fields, "index_pos").value_or(0);
  Contents contents;
  Result<> listed;
  if (index_at != 0) {
    listed = read_lists(source, *header, index_at, contents);
    if (listed) return contents;
    contents = {};
  }
  const Result<> scanned = scan_file(source, contents);
  const std::size_t num_messages = contents.bag.messages.size();
  const std::string fault = scanned ? format("it ends at byte {}", source.size) : scanned.error().message;
  if (num_messages == 0) return fail(torn_text(contents, fault));
  if (!scanned)
    contents.bag.warnings.push_back(torn_text(contents, fault));
  else if (!listed)
    contents.bag.warnings.push_back(index_warning(listed.error().message, num_messages, "rosbag reindex"));
  return contents;
}

/// Reads messages, and keeps the chunks that were read last.
class Messages {
 public:
  Messages(ByteSource source, std::vector<std::uint64_t> chunks, std::optional<Record> truncated,
           std::vector<Place> places)
      : source_(std::move(source)),
        chunks_(std::move(chunks)),
        truncated_(std::move(truncated)),
        places_(std::move(places)) {}

  Result<std::string> read(std::uint64_t where) {
    const Place place = places_.at(where);
    if (!place.chunk) return read_message(source_, place.offset);
    const std::uint64_t chunk = chunks_[*place.chunk];
    const Result<RecentChunks::Records> records = recent_.get(*place.chunk, [&] {
      const bool is_truncated = truncated_ && truncated_->offset == chunk;
      return is_truncated ? read_truncated_chunk(source_, *truncated_) : read_chunk(source_, chunk);
    });
    if (!records) return tl::unexpected(records.error());
    Result<std::string> message = read_message(memory_source(*records), place.offset);
    if (!message) return fail(format("chunk at byte {}", chunk), message.error());
    return message;
  }

 private:
  static Result<std::string> read_message(const ByteSource& from, std::uint64_t offset) {
    const Result<Record> record = read_record(from, offset);
    if (!record) return tl::unexpected(record.error());
    if (record->op != Op::message) return fail_at(offset, "no message where the index announces one");
    return from.read(record->data, record->size);
  }

  ByteSource source_;
  std::vector<std::uint64_t> chunks_;
  std::optional<Record> truncated_;
  std::vector<Place> places_;
  RecentChunks recent_;
};

}  // namespace
}  // namespace ros1

Result<Bag> open_ros1_bag(ByteSource source) {
  const std::uint64_t num_bytes = source.size;
  return ros1::read_contents(source).map([&](ros1::Contents contents) {
    std::ranges::stable_sort(contents.bag.messages, {}, &BagMessage::log_time);
    const auto messages =
        std::make_shared<ros1::Messages>(std::move(source), std::move(contents.chunks),
                                         std::move(contents.truncated), std::move(contents.places));
    contents.bag.storage = "ros1";
    contents.bag.num_bytes = num_bytes;
    contents.bag.read = [messages](const BagMessage& message) { return messages->read(message.where); };
    return std::move(contents.bag);
  });
}

}  // namespace adit

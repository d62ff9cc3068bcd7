// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/mcap_records.hpp"

#include <cstring>
#include <type_traits>

#include "adit/core/check.hpp"
#include "adit/io/packed_cloud.hpp"

namespace adit::mcap {
namespace {

class Encoder {
 public:
  template <class... Values>
  void operator()(const Values&... values) {
    (put(values), ...);
  }
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  template <class T>
  requires(std::is_integral_v<T>) void put(T value) { append_little_endian(bytes_, value); }
  void put(Opcode opcode) { put(static_cast<std::uint8_t>(opcode)); }
  void put(Stamp stamp) {
    ADIT_CHECK(stamp.ns >= 0, "MCAP holds no stamps before 0");
    put(static_cast<std::uint64_t>(stamp.ns));
  }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    bytes_ += text;
  }
  template <class A, class B>
  void put(const std::pair<A, B>& pair) {
    put(pair.first);
    put(pair.second);
  }
  /// Maps and lists: their length in bytes, then the entries.
  template <class Container>
  requires requires(const Container& c) { c.begin()->second; }
  void put(const Container& entries) {
    Encoder nested;
    for (const auto& entry : entries) nested(entry);
    put(nested.take());
  }

  std::string bytes_;
};

class Decoder {
 public:
  explicit Decoder(std::string_view bytes) : rest_(bytes) {}
  template <class... Values>
  void operator()(Values&... values) {
    (get(values), ...);
  }
  [[nodiscard]] bool ok() const { return ok_; }
  [[nodiscard]] std::string_view rest() const { return rest_; }

 private:
  std::string_view take(std::uint64_t size) {
    ok_ = ok_ && size <= rest_.size();
    if (!ok_) return {};
    const std::string_view taken = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return taken;
  }
  template <class T>
  requires(std::is_integral_v<T>) void get(T& value) {
    const std::string_view raw = take(sizeof(T));
    if (ok_) std::memcpy(&value, raw.data(), sizeof(T));
  }
  void get(Opcode& opcode) {
    std::uint8_t raw = 0;
    get(raw);
    opcode = static_cast<Opcode>(raw);
  }
  void get(Stamp& stamp) {
    std::uint64_t raw = 0;
    get(raw);
    // A clock that is beyond is damaged, which must not cost the message.
    stamp.ns = static_cast<std::int64_t>(std::min(raw, static_cast<std::uint64_t>(INT64_MAX)));
  }
  void get(std::string& text) {
    std::uint32_t size = 0;
    get(size);
    text = take(size);
  }
  template <class A, class B>
  void get(std::pair<A, B>& pair) {
    get(pair.first);
    get(pair.second);
  }
  template <class Key, class Value>
  void get(std::map<Key, Value>& entries) {
    for_each_entry<std::pair<Key, Value>>([&](auto entry) { entries.insert(std::move(entry)); });
  }
  template <class Entry>
  void get(std::vector<Entry>& entries) {
    for_each_entry<Entry>([&](Entry entry) { entries.push_back(std::move(entry)); });
  }
  template <class Entry, class Use>
  void for_each_entry(const Use& use) {
    std::uint32_t size = 0;
    get(size);
    Decoder nested(take(size));
    while (ok_ && !nested.rest_.empty()) {
      Entry entry;
      nested.get(entry);
      ok_ = nested.ok_;
      if (ok_) use(std::move(entry));
    }
  }

  std::string_view rest_;
  bool ok_ = true;
};

}  // namespace

template <class Record>
std::string encode(Record record) {
  Encoder encoder;
  visit_fields(record, encoder);
  return encoder.take();
}
template std::string encode(Header);
template std::string encode(Footer);
template std::string encode(Schema);
template std::string encode(Channel);
template std::string encode(MessageIndex);
template std::string encode(ChunkIndex);
template std::string encode(Statistics);
template std::string encode(Metadata);
template std::string encode(MetadataIndex);
template std::string encode(SummaryOffset);

std::string encode(const Message& message) {
  Encoder encoder;
  encoder(message.channel_id, message.sequence, message.log_time, message.publish_time);
  return encoder.take() + message.data;
}

std::string encode(const Chunk& chunk) {
  Encoder encoder;
  encoder(chunk.start, chunk.end, chunk.uncompressed_size, chunk.uncompressed_crc, chunk.compression,
          std::uint64_t{chunk.records.size()});
  return encoder.take().append(chunk.records);
}

std::string framed(Opcode opcode, std::string_view content) {
  Encoder encoder;
  encoder(opcode, std::uint64_t{content.size()});
  return encoder.take().append(content);
}

template <class Record>
std::optional<Record> decode(std::string_view content) {
  Record record;
  Decoder decoder(content);
  visit_fields(record, decoder);
  return decoder.ok() ? std::optional(std::move(record)) : std::nullopt;
}
template std::optional<Header> decode(std::string_view);
template std::optional<Footer> decode(std::string_view);
template std::optional<Schema> decode(std::string_view);
template std::optional<Channel> decode(std::string_view);
template std::optional<MessageIndex> decode(std::string_view);
template std::optional<ChunkIndex> decode(std::string_view);
template std::optional<Statistics> decode(std::string_view);
template std::optional<Metadata> decode(std::string_view);
template std::optional<MetadataIndex> decode(std::string_view);
template std::optional<SummaryOffset> decode(std::string_view);

template <>
std::optional<Message> decode<Message>(std::string_view content) {
  Message message;
  Decoder decoder(content);
  decoder(message.channel_id, message.sequence, message.log_time, message.publish_time);
  message.data = decoder.rest();
  return decoder.ok() ? std::optional(std::move(message)) : std::nullopt;
}

namespace {

std::optional<Chunk> chunk_in(std::string_view content, bool may_be_cut) {
  Chunk chunk;
  std::uint64_t size = 0;
  Decoder decoder(content);
  decoder(chunk.start, chunk.end, chunk.uncompressed_size, chunk.uncompressed_crc, chunk.compression, size);
  if (!decoder.ok() || (size > decoder.rest().size() && !may_be_cut)) return std::nullopt;
  chunk.records = decoder.rest().substr(0, size);
  return chunk;
}

}  // namespace

template <>
std::optional<Chunk> decode<Chunk>(std::string_view content) {
  return chunk_in(content, false);
}

std::optional<Chunk> decode_cut_chunk(std::string_view content) { return chunk_in(content, true); }

std::optional<RecordView> RecordCursor::next() {
  const std::string_view rest = bytes_.substr(offset_);
  if (rest.size() < kRecordHead) return std::nullopt;
  std::uint64_t length = 0;
  std::memcpy(&length, rest.data() + 1, sizeof(length));
  if (length > rest.size() - kRecordHead) return std::nullopt;
  const RecordView record{static_cast<Opcode>(rest[0]), offset_, rest.substr(kRecordHead, length)};
  offset_ += kRecordHead + length;
  return record;
}

}  // namespace adit::mcap

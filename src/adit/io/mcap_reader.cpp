// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/mcap_reader.hpp"

#include <algorithm>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/io/compression.hpp"
#include "adit/io/crc32.hpp"
#include "adit/io/distinct_parts.hpp"

namespace adit::mcap {
namespace {

tl::unexpected<Error> fail_at(std::uint64_t offset, std::string_view message) {
  return fail(format("byte {}: {}", offset, message));
}

template <class Record>
Result<Record> decode_at(std::uint64_t offset, std::string_view content, std::string_view name) {
  std::optional<Record> record = decode<Record>(content);
  if (!record) return fail_at(offset, format("damaged {} record", name));
  return std::move(*record);
}

/// What stands in front of a record's content.
struct RecordHead {
  Opcode opcode = Opcode::header;
  std::uint64_t offset = 0;  ///< Of the head itself.
  std::uint64_t length = 0;  ///< Of the content, which ends within the file.
  [[nodiscard]] std::uint64_t end() const { return offset + kRecordHead + length; }
};

/// A record of the file with its content.
struct FileRecord {
  Opcode opcode = Opcode::header;
  std::string content;
};

Result<RecordHead> read_head(const ByteSource& source, std::uint64_t offset) {
  const Result<std::string> bytes = source.read(offset, kRecordHead);
  if (!bytes) return tl::unexpected(bytes.error());
  RecordHead head{static_cast<Opcode>((*bytes)[0]), offset, 0};
  for (std::size_t i = 8; i >= 1; --i)
    head.length = (head.length << 8U) | static_cast<std::uint8_t>((*bytes)[i]);
  if (head.length > source.size - offset - kRecordHead)
    return fail_at(offset, format("a record of {} bytes reaches past the end of the file", head.length));
  return head;
}

Result<FileRecord> read_content(const ByteSource& source, const RecordHead& head) {
  return source.read(head.offset + kRecordHead, head.length).map([&](std::string content) {
    return FileRecord{head.opcode, std::move(content)};
  });
}

Result<FileRecord> read_record(const ByteSource& source, std::uint64_t offset) {
  return read_head(source, offset).and_then([&](const RecordHead& head) {
    return read_content(source, head);
  });
}

Result<std::string> expand(const Chunk& chunk, std::uint64_t offset) {
  Result<std::string> records = decompress(chunk.records, chunk.compression, chunk.uncompressed_size);
  if (!records) return fail(format("chunk at byte {}", offset), records.error());
  if (chunk.uncompressed_crc != 0 && crc32(*records) != chunk.uncompressed_crc) {
    return fail(format("chunk at byte {}: its checksum does not fit; the file is damaged", offset));
  }
  return records;
}

Result<std::string> read_chunk(const ByteSource& source, std::uint64_t offset) {
  const Result<FileRecord> record = read_record(source, offset);
  if (!record) return tl::unexpected(record.error());
  if (record->opcode != Opcode::chunk)
    return fail_at(offset, "the index announces a chunk here, but there is another record");
  return decode_at<Chunk>(offset, record->content, "chunk").and_then([&](const Chunk& chunk) {
    return expand(chunk, offset);
  });
}

/// The front of the records of a chunk that reaches past the end of the file.
Result<std::string> read_cut_chunk(const ByteSource& source, std::uint64_t offset) {
  constexpr std::uint64_t kMost = std::uint64_t{1}
                                  << 28U;  // a damaged length is no reason to read all the rest
  const Result<std::string> bytes = source.read(offset, std::min(source.size - offset, kMost));
  if (!bytes) return tl::unexpected(bytes.error());
  if (bytes->size() < kRecordHead || static_cast<Opcode>(bytes->front()) != Opcode::chunk)
    return fail_at(offset, "no chunk");
  const std::optional<Chunk> chunk = decode_cut_chunk(std::string_view(*bytes).substr(kRecordHead));
  if (!chunk) return fail_at(offset, "a chunk is cut off in its head");
  return decompress_front(chunk->records, chunk->compression, std::min(chunk->uncompressed_size, kMost));
}

/// Schemas and channels, wherever they stand.
Result<> take_definition(Contents& contents, Opcode opcode, std::uint64_t offset, std::string_view content) {
  if (opcode == Opcode::schema) {
    return decode_at<Schema>(offset, content, "schema").map([&](Schema schema) {
      contents.schemas.insert_or_assign(schema.id, std::move(schema));
    });
  }
  if (opcode == Opcode::channel) {
    return decode_at<Channel>(offset, content, "channel").map([&](Channel channel) {
      contents.channels.insert_or_assign(channel.id, std::move(channel));
    });
  }
  return {};
}

/// Notes every whole message of an expanded chunk. How far whole records reach.
Result<std::uint64_t> index_front(Contents& contents, std::string_view records, std::size_t chunk) {
  RecordCursor cursor(records);
  while (const std::optional<RecordView> record = cursor.next()) {
    if (Result<> taken = take_definition(contents, record->opcode, record->offset, record->content); !taken)
      return tl::unexpected(taken.error());
    if (record->opcode != Opcode::message) continue;
    const Result<Message> message = decode_at<Message>(record->offset, record->content, "message");
    if (!message) return tl::unexpected(message.error());
    contents.messages.push_back({message->channel_id, message->log_time, chunk, record->offset});
  }
  return cursor.offset();
}

/// Notes every message of an expanded chunk.
Result<> index_records(Contents& contents, std::string_view records, std::size_t chunk) {
  const Result<std::uint64_t> end = index_front(contents, records, chunk);
  if (!end) return tl::unexpected(end.error());
  if (*end == records.size()) return {};
  return fail_at(*end, "a record of the chunk reaches past its end");
}

/// What is there of a chunk that reaches past the end of the file, as far as it can be read.
void scan_cut_chunk(const ByteSource& source, Contents& contents, std::uint64_t offset) {
  const Result<std::string> records = read_cut_chunk(source, offset);
  if (!records) return;
  contents.cut_chunk = contents.chunks.size();
  contents.chunks.emplace_back().chunk_start = offset;
  const std::size_t num_before = contents.messages.size();
  // What was read in front of it stays, whatever follows.
  if (!index_front(contents, *records, *contents.cut_chunk)) contents.messages.resize(num_before);
  std::erase_if(contents.messages, [&](const MessageRef& message) {
    return message.chunk == contents.cut_chunk && !contents.channels.contains(message.channel_id);
  });
}

Result<> scan_chunk(Contents& contents, std::uint64_t offset, std::string_view content) {
  const Result<Chunk> chunk = decode_at<Chunk>(offset, content, "chunk");
  if (!chunk) return tl::unexpected(chunk.error());
  const Result<std::string> records = expand(*chunk, offset);
  if (!records) return tl::unexpected(records.error());
  contents.chunks.push_back({chunk->start,
                             chunk->end,
                             offset,
                             kRecordHead + content.size(),
                             {},
                             0,
                             chunk->compression,
                             chunk->records.size(),
                             chunk->uncompressed_size});
  const Result<> indexed = index_records(contents, *records, contents.chunks.size() - 1);
  if (!indexed) return fail(format("chunk at byte {}", offset), indexed.error());
  return {};
}

Result<> scan_record(Contents& contents, std::uint64_t offset, const FileRecord& record) {
  switch (record.opcode) {
    case Opcode::header:
      return decode_at<Header>(offset, record.content, "header").map([&](Header header) {
        contents.header = std::move(header);
      });
    case Opcode::message:
      return decode_at<Message>(offset, record.content, "message").map([&](const Message& message) {
        contents.messages.push_back({message.channel_id, message.log_time, std::nullopt, offset});
      });
    case Opcode::metadata:
      return decode_at<Metadata>(offset, record.content, "metadata").map([&](Metadata metadata) {
        contents.metadata.push_back(std::move(metadata));
      });
    case Opcode::chunk:
      return scan_chunk(contents, offset, record.content);
    default:
      return take_definition(contents, record.opcode, offset, record.content);
  }
}

/// Attachments, which can be of any size, and other records that say nothing of messages are not read.
bool is_of_use(Opcode opcode) {
  switch (opcode) {
    case Opcode::header:
    case Opcode::schema:
    case Opcode::channel:
    case Opcode::message:
    case Opcode::chunk:
    case Opcode::metadata:
      return true;
    default:
      return false;
  }
}

/// Goes through the data section from its start. What was read before an error stays in `contents`.
Result<> scan_data(const ByteSource& source, Contents& contents) {
  for (std::uint64_t offset = kMagic.size();;) {
    throw_if_cancelled();
    const Result<RecordHead> head = read_head(source, offset);
    if (!head) {
      scan_cut_chunk(source, contents, offset);
      return tl::unexpected(head.error());
    }
    if (head->opcode == Opcode::data_end || head->opcode == Opcode::footer) return {};
    if (is_of_use(head->opcode)) {
      const Result<> scanned = read_content(source, *head).and_then([&](const FileRecord& record) {
        return scan_record(contents, offset, record);
      });
      if (!scanned) return scanned;
    }
    offset = head->end();
  }
}

Result<> check_start(const ByteSource& source) {
  const Result<std::string> magic = source.read(0, std::min<std::uint64_t>(source.size, kMagic.size()));
  if (!magic) return tl::unexpected(magic.error());
  if (*magic != kMagic) return fail("byte 0: not an MCAP file, or truncated");
  return {};
}

Result<> check_channels(const Contents& contents) {
  for (const MessageRef& message : contents.messages) {
    if (contents.channels.contains(message.channel_id)) continue;
    return fail(format("a message refers to channel {}, which is not defined", message.channel_id));
  }
  return {};
}

/// What can be read of a file that ends early.
Result<Contents> contents_before_cut(const ByteSource& source) {
  Contents contents;
  const Result<> scanned = scan_data(source, contents);
  contents.torn = scanned ? format("byte {}: the file ends without a footer", source.size)
                          : format("the file breaks off: {}", scanned.error().message);
  if (contents.messages.empty())
    return fail(
        format("{}, and no message is whole; copy the file again from where it was recorded", contents.torn));
  return check_channels(contents).map([&] { return std::move(contents); });
}

/// Nothing where the file ends early.
Result<std::optional<Footer>> read_footer(const ByteSource& source) {
  constexpr std::uint64_t kTail = kFooterSize + kMagic.size();
  if (source.size < kMagic.size() + kTail) return std::nullopt;
  const std::uint64_t offset = source.size - kTail;
  const Result<std::string> tail = source.read(offset, kTail);
  if (!tail) return tl::unexpected(tail.error());
  if (!tail->ends_with(kMagic)) return std::nullopt;
  RecordCursor cursor(*tail);
  const std::optional<RecordView> record = cursor.next();
  if (!record || record->opcode != Opcode::footer)
    return fail_at(offset, "no footer before the closing magic bytes");
  return decode_at<Footer>(offset, record->content, "footer").map([](const Footer& footer) {
    return std::optional(footer);
  });
}

/// The bytes of the summary, checked.
Result<std::string> read_summary(const ByteSource& source, const Footer& footer) {
  const std::uint64_t end = source.size - kMagic.size();  // of the footer
  if (footer.summary_start > end - kFooterSize) {
    return fail_at(end - kFooterSize,
                   format("the footer puts the summary at byte {}, behind itself", footer.summary_start));
  }
  Result<std::string> summary = source.read(footer.summary_start, end - footer.summary_start);
  if (!summary) return summary;
  const std::string_view covered =
      std::string_view(*summary).substr(0, summary->size() - sizeof(footer.summary_crc));
  if (footer.summary_crc != 0 && crc32(covered) != footer.summary_crc) {
    return fail_at(footer.summary_start, "the checksum of the summary does not fit; the file is damaged");
  }
  summary->resize(summary->size() - kFooterSize);
  return summary;
}

Result<> read_metadata(const ByteSource& source, Contents& contents, DistinctParts& parts,
                       const MetadataIndex& index) {
  const Result<FileRecord> record = read_record(source, index.offset);
  if (!record) return tl::unexpected(record.error());
  if (record->opcode != Opcode::metadata)
    return fail_at(index.offset, "the index announces metadata here, but there is another record");
  if (!parts.add(index.offset, kRecordHead + record->content.size()))
    return fail_at(index.offset, "the index names this record twice");
  return scan_record(contents, index.offset, *record);
}

/// The messages of one chunk, from the index records behind it.
Result<> read_message_index(const ByteSource& source, Contents& contents, std::size_t chunk) {
  const ChunkIndex index = contents.chunks[chunk];
  if (index.message_index_length == 0) {
    return read_chunk(source, index.chunk_start).and_then([&](const std::string& records) {
      return index_records(contents, records, chunk);
    });
  }
  const std::uint64_t start = index.chunk_start + index.chunk_length;
  const Result<std::string> bytes = source.read(start, index.message_index_length);
  if (!bytes) return tl::unexpected(bytes.error());
  RecordCursor cursor(*bytes);
  while (const std::optional<RecordView> record = cursor.next()) {
    if (record->opcode != Opcode::message_index) return fail_at(start + record->offset, "no message index");
    const auto entries = decode_at<MessageIndex>(start + record->offset, record->content, "message index");
    if (!entries) return tl::unexpected(entries.error());
    for (const auto& [time, offset] : entries->entries) {
      if (time > static_cast<std::uint64_t>(INT64_MAX))
        return fail_at(start + record->offset,
                       format("a message index has the time {} ns, after 2262", time));
      contents.messages.push_back({entries->channel_id, {static_cast<std::int64_t>(time)}, chunk, offset});
    }
  }
  if (cursor.offset() == bytes->size()) return {};
  return fail_at(start + cursor.offset(), "a message index reaches past its end");
}

Result<> take_chunk_index(Contents& contents, DistinctParts& parts, std::uint64_t offset, ChunkIndex index) {
  if (!parts.add(index.chunk_start, std::max(index.chunk_length, kRecordHead)) ||
      !parts.add(index.chunk_start + index.chunk_length, index.message_index_length))
    return fail_at(offset, "the summary names a chunk twice, or chunks that overlap");
  contents.chunks.push_back(std::move(index));
  return {};
}

Result<> take_summary_record(const ByteSource& source, Contents& contents, DistinctParts& parts,
                             std::uint64_t offset, const RecordView& record) {
  if (record.opcode == Opcode::chunk_index) {
    return decode_at<ChunkIndex>(offset, record.content, "chunk index").and_then([&](ChunkIndex index) {
      return take_chunk_index(contents, parts, offset, std::move(index));
    });
  }
  if (record.opcode == Opcode::metadata_index) {
    return decode_at<MetadataIndex>(offset, record.content, "metadata index")
        .and_then([&](const MetadataIndex& index) { return read_metadata(source, contents, parts, index); });
  }
  return take_definition(contents, record.opcode, offset, record.content);
}

Result<Contents> contents_from_summary(const ByteSource& source, const Footer& footer) {
  const Result<std::string> summary = read_summary(source, footer);
  if (!summary) return tl::unexpected(summary.error());
  Contents contents;
  DistinctParts parts;
  RecordCursor cursor(*summary);
  while (const std::optional<RecordView> record = cursor.next()) {
    const std::uint64_t offset = footer.summary_start + record->offset;
    if (Result<> taken = take_summary_record(source, contents, parts, offset, *record); !taken) {
      return tl::unexpected(taken.error());
    }
  }
  if (cursor.offset() != summary->size()) {
    return fail_at(footer.summary_start + cursor.offset(), "a record of the summary reaches past its end");
  }
  for (std::size_t i = 0; i < contents.chunks.size(); ++i) {
    if (Result<> read = read_message_index(source, contents, i); !read) return tl::unexpected(read.error());
  }
  const Result<FileRecord> header = read_record(source, kMagic.size());
  if (!header) return tl::unexpected(header.error());
  return scan_record(contents, kMagic.size(), *header).map([&] { return std::move(contents); });
}

/// A summary may leave out any kind of record; without channels, their schemas and chunks it cannot serve as
/// the index.
bool is_complete(const Contents& contents) {
  const bool has_schemas = std::ranges::all_of(contents.channels, [&](const auto& channel) {
    return channel.second.schema_id == 0 || contents.schemas.contains(channel.second.schema_id);
  });
  return has_schemas && !contents.chunks.empty() &&
         std::ranges::all_of(contents.messages, [&](const MessageRef& message) {
           return contents.channels.contains(message.channel_id);
         });
}

/// Of a file that has an end. The data of a file may be whole where its summary is not.
Result<Contents> read_contents(const ByteSource& source, const Result<std::optional<Footer>>& footer) {
  Result<> summary;
  if (!footer) summary = tl::unexpected(footer.error());
  if (footer && (*footer)->summary_start != 0) {
    Result<Contents> contents = contents_from_summary(source, **footer);
    if (contents && is_complete(*contents)) return contents;
    if (!contents) summary = tl::unexpected(contents.error());
  }
  Contents contents;
  Result<> read = scan_data(source, contents).and_then([&] { return check_channels(contents); });
  if (!read && !summary && !contents.messages.empty() && check_channels(contents)) {
    contents.torn = read.error().message;  // as of a file that was cut there
    return contents;
  }
  if (!read && !summary)
    return fail(
        format("{}; its index cannot be used either ({})", read.error().message, summary.error().message));
  if (!summary) contents.summary_fault = summary.error().message;
  return read.map([&] { return std::move(contents); });
}

}  // namespace

Result<Reader> Reader::open(ByteSource source) {
  if (Result<> start = check_start(source); !start) return tl::unexpected(start.error());
  const Result<std::optional<Footer>> footer = read_footer(source);
  const bool ends_early = footer && !*footer;
  Result<Contents> found = ends_early ? contents_before_cut(source) : read_contents(source, footer);
  return std::move(found).map([&](Contents contents) {
    std::ranges::stable_sort(contents.messages, {}, &MessageRef::log_time);
    return Reader(std::move(source), std::move(contents));
  });
}

Result<Message> Reader::read(const MessageRef& ref) const {
  if (!ref.chunk) {
    return read_record(source_, ref.offset).and_then([&](const FileRecord& record) {
      return decode_at<Message>(ref.offset, record.content, "message");
    });
  }
  const std::uint64_t chunk_start = contents_.chunks[*ref.chunk].chunk_start;
  const bool is_cut = ref.chunk == contents_.cut_chunk;
  const auto records = recent_->get(*ref.chunk, [&] {
    return is_cut ? read_cut_chunk(source_, chunk_start) : read_chunk(source_, chunk_start);
  });
  if (!records) return tl::unexpected(records.error());
  const std::string_view bytes = **records;
  RecordCursor cursor(bytes.substr(std::min<std::uint64_t>(ref.offset, bytes.size())));
  const std::optional<RecordView> record = cursor.next();
  if (!record || record->opcode != Opcode::message) {
    return fail(format("chunk at byte {}: no message at its offset {}", chunk_start, ref.offset));
  }
  return decode_at<Message>(chunk_start, record->content, "message");
}

}  // namespace adit::mcap

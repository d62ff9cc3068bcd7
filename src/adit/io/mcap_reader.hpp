// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Reads MCAP files: indexed ones by their summary, others by going through them once.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/io/byte_source.hpp"
#include "adit/io/mcap_records.hpp"
#include "adit/io/recent_chunks.hpp"

namespace adit::mcap {

/// Where a message lies: in a chunk (offset in its uncompressed records) or in the file itself.
struct MessageRef {
  std::uint16_t channel_id = 0;      ///< In Contents::channels.
  Stamp log_time;                    ///< When it was recorded.
  std::optional<std::size_t> chunk;  ///< Index into the reader's chunks.
  std::uint64_t offset = 0;          ///< Of the record's head.
};

/// What a file holds, without the messages themselves.
struct Contents {
  Header header;                              ///< Both texts may be empty.
  std::map<std::uint16_t, Schema> schemas;    ///< By id.
  std::map<std::uint16_t, Channel> channels;  ///< By id. All that messages refer to are there.
  std::vector<Metadata> metadata;             ///< Whole records, in the order of the file or its index.
  std::vector<ChunkIndex> chunks;             ///< In the order of the file or its index.
  std::vector<MessageRef> messages;  ///< By log time; equal times in the order of the file or its indexes.
  /// Of `chunks`, the one that reaches past the end of the file; the records in front of the cut are read
  /// (decompress_front). Its checksum is of all of it, so that nothing verifies these.
  std::optional<std::size_t> cut_chunk;
  std::string torn;           ///< Where the file breaks off and why; "" where it is whole.
  std::string summary_fault;  ///< Why a summary that is there could not be used; "" where it could.
};

/// A file that is open, with its index in memory.
class Reader {
 public:
  /// Errors name the byte offset: no MCAP file, damaged records, checksums that differ. A file whose summary
  /// is damaged is gone through from its start. Of a file that ends early (no footer), as after an
  /// interrupted recording, the whole records in front of the cut are read, in a chunk that is cut, too; none
  /// is an error.
  static Result<Reader> open(ByteSource source);

  /// Found once, by `open`.
  [[nodiscard]] const Contents& contents() const { return contents_; }
  /// May be called from any thread. The chunks read last are kept, so reading in order expands each chunk
  /// once.
  [[nodiscard]] Result<Message> read(const MessageRef& ref) const;

 private:
  Reader(ByteSource source, Contents contents) : source_(std::move(source)), contents_(std::move(contents)) {}

  ByteSource source_;
  Contents contents_;
  std::shared_ptr<RecentChunks> recent_ = std::make_shared<RecentChunks>();
};

}  // namespace adit::mcap

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Writes MCAP files: chunks compressed with zstd, message and chunk indexes, statistics, checksums.
#pragma once

#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "adit/io/mcap_records.hpp"

namespace adit::mcap {

/// Everything goes to `out`, in order; errors of the stream are the caller's to check after `finish`.
class Writer {
 public:
  /// Writes the start of the file. `out` must outlive the writer.
  Writer(std::ostream& out, const Header& header);

  /// Returns the new schema's id.
  std::uint16_t add_schema(const std::string& name, const std::string& encoding, const std::string& data);
  /// Returns the new channel's id.
  std::uint16_t add_channel(const std::string& topic, const std::string& message_encoding,
                            std::uint16_t schema_id);
  /// Writes the messages, one or more, as one chunk. Channels must have been added.
  void write_chunk(const std::vector<Message>& messages);
  /// Between chunks; the summary will say where.
  void write_metadata(const Metadata& metadata);
  /// Writes summary and footer; nothing may follow.
  void finish();

 private:
  void write(std::string_view bytes);
  void write_group(Opcode opcode, const std::vector<std::string>& records,
                   std::vector<SummaryOffset>& groups);

  std::ostream& out_;
  std::uint64_t offset_ = 0;
  std::uint32_t crc_ = 0;  ///< Of the section that is being written.
  std::vector<Schema> schemas_;
  std::vector<Channel> channels_;
  std::vector<ChunkIndex> chunks_;
  std::vector<MetadataIndex> metadata_;
  Statistics statistics_;
};

}  // namespace adit::mcap

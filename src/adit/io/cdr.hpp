// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The encodings of ROS messages. CDR, that of ROS 2: four bytes that state the byte order, then numbers
/// aligned to their own size (counted from behind those four bytes). Source: OMG DDS-XTypes 1.3, section 7.4
/// (plain CDR, version 1).
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "adit/io/packed_cloud.hpp"

namespace adit {

/// Writes little-endian CDR.
class CdrWriter {
 public:
  CdrWriter() : bytes_("\0\1\0\0", 4) {}

  /// Aligned to its size. Returns the writer, as `text` and `blob` do, so that calls can be chained.
  template <class T>
  CdrWriter& number(T value) {
    while ((bytes_.size() - 4) % sizeof(T) != 0) bytes_ += '\0';
    append_little_endian(bytes_, value);
    return *this;
  }
  /// The length with a zero at the end, the text, the zero.
  CdrWriter& text(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size() + 1));
    bytes_.append(value);
    bytes_ += '\0';
    return *this;
  }
  /// A sequence of bytes.
  CdrWriter& blob(std::string_view value) {
    number(static_cast<std::uint32_t>(value.size()));
    bytes_.append(value);
    return *this;
  }
  /// The whole message. Ends the writer.
  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// How the bytes of a message are laid out.
enum class MessageEncoding {
  cdr,
  ros1,  ///< Little-endian without any alignment. Source: the ROS 1 wiki, "msg", field types.
};

/// Reads CDR of either byte order, and what ROS 1 writes. After a value that reaches past the end all values
/// are zero or empty, and `ok` is false: check it once, at the end.
class MessageReader {
 public:
  /// `bytes`, a whole message, must outlive the reader and the texts that it returns.
  explicit MessageReader(std::string_view bytes, MessageEncoding encoding = MessageEncoding::cdr)
      : encoding_(encoding) {
    if (encoding == MessageEncoding::ros1) {
      body_ = bytes;
      ok_ = true;
      return;
    }
    ok_ = bytes.size() >= 4 && bytes[0] == '\0' && (bytes[1] == '\0' || bytes[1] == '\1');
    if (!ok_) return;
    order_ = bytes[1] == '\1' ? std::endian::little : std::endian::big;
    body_ = bytes.substr(4);
  }

  /// The next number; in CDR behind the padding that aligns it.
  template <class T>
  [[nodiscard]] T number() {
    if (encoding_ == MessageEncoding::cdr) offset_ = (offset_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
    std::array<char, sizeof(T)> raw{};
    const std::string_view taken = take(sizeof(T));
    std::ranges::copy(taken, raw.begin());
    if (order_ != std::endian::native) std::ranges::reverse(raw);
    return std::bit_cast<T>(raw);
  }
  /// Part of the message, without the zero at its end.
  [[nodiscard]] std::string_view text() {
    std::string_view value = take(number<std::uint32_t>());
    if (value.ends_with('\0')) value.remove_suffix(1);
    return value;
  }
  /// A sequence of bytes; part of the message.
  [[nodiscard]] std::string_view blob() { return take(number<std::uint32_t>()); }
  /// What has not been read; in CDR from the next byte on that is aligned to four.
  [[nodiscard]] std::string_view rest() {
    if (encoding_ == MessageEncoding::cdr) offset_ = (offset_ + 3) / 4 * 4;
    ok_ = ok_ && offset_ <= body_.size();
    return ok_ ? body_.substr(offset_) : std::string_view();
  }
  /// Of the numbers. Of ROS 1 always little.
  [[nodiscard]] std::endian order() const { return order_; }
  /// Whether the message held all that was read.
  [[nodiscard]] bool ok() const { return ok_; }
  /// As the reader was told.
  [[nodiscard]] MessageEncoding encoding() const { return encoding_; }
  /// Behind the last value, for messages about damage.
  [[nodiscard]] std::size_t offset() const { return offset_ + (encoding_ == MessageEncoding::cdr ? 4 : 0); }

 private:
  std::string_view take(std::size_t size) {
    ok_ = ok_ && offset_ <= body_.size() && size <= body_.size() - offset_;
    if (!ok_) return {};
    const std::string_view taken = body_.substr(offset_, size);
    offset_ += size;
    return taken;
  }

  MessageEncoding encoding_;
  std::string_view body_;
  std::size_t offset_ = 0;
  std::endian order_ = std::endian::little;
  bool ok_ = false;
};

}  // namespace adit

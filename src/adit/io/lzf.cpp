// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/lzf.hpp"

#include <algorithm>
#include <cstdint>

#include "adit/core/format.hpp"

namespace adit {
namespace {

constexpr std::size_t kLongestLiteral = 32;
constexpr std::size_t kLongestRepeat = 7 + 255 + 2;

std::size_t byte_at(std::string_view stream, std::size_t i) { return static_cast<std::uint8_t>(stream[i]); }

std::size_t run_length(std::string_view bytes, std::size_t begin) {
  std::size_t end = begin;
  while (end < bytes.size() && end - begin < kLongestRepeat && bytes[end] == bytes[begin - 1]) ++end;
  return end - begin;
}

/// `length` times the byte before: a back reference of distance 1 that overlaps itself.
void append_repeat(std::string& stream, std::size_t length) {
  const std::size_t code = length - 2;
  stream += static_cast<char>(std::min<std::size_t>(code, 7) << 5U);
  if (code >= 7) stream += static_cast<char>(code - 7);
  stream += '\0';
}

void append_literal(std::string& stream, std::string_view bytes) {
  for (; !bytes.empty(); bytes.remove_prefix(std::min(bytes.size(), kLongestLiteral))) {
    const std::string_view part = bytes.substr(0, kLongestLiteral);
    stream += static_cast<char>(part.size() - 1);
    stream += part;
  }
}

}  // namespace

Result<std::string> expand_lzf(std::string_view stream, std::size_t size) {
  // No LZF stream expands more than 264 bytes out of three; a larger claim is damage, found before memory is
  // taken.
  if (size / kLongestRepeat > stream.size()) {
    return fail(format("{} compressed bytes cannot hold {} bytes; the size is damaged", stream.size(), size));
  }
  std::string out;
  out.reserve(size);
  std::size_t i = 0;
  while (i < stream.size()) {
    const std::size_t start = i;
    const std::size_t control = byte_at(stream, i++);
    const bool is_literal = control < kLongestLiteral;
    std::size_t length = is_literal ? control + 1 : control >> 5U;
    const std::size_t num_operands = is_literal ? length : (length == 7 ? 2 : 1);
    if (num_operands > stream.size() - i)
      return fail(format("compressed byte {}: the stream ends inside a run", start));
    if (is_literal) {
      out.append(stream, i, length);
      i += length;
    } else {
      if (length == 7) length += byte_at(stream, i++);
      length += 2;
      const std::size_t distance = ((control & 31U) << 8U) + byte_at(stream, i++) + 1;
      if (distance > out.size()) return fail(format("compressed byte {}: refers to before the start", start));
      if (length > size - out.size())
        return fail(format("compressed byte {}: expands past {} bytes", start, size));
      // Byte by byte: the reference may overlap what it writes.
      for (std::size_t k = 0; k < length; ++k) out.push_back(out[out.size() - distance]);
    }
    if (out.size() > size) return fail(format("compressed byte {}: expands past {} bytes", start, size));
  }
  if (out.size() != size)
    return fail(format("expands to {} bytes, not to the {} announced", out.size(), size));
  return out;
}

std::string compress_lzf(std::string_view bytes) {
  std::string stream;
  std::size_t literal = 0;
  for (std::size_t i = 1; i < bytes.size();) {
    const std::size_t length = run_length(bytes, i);
    if (length < 3) {
      i += std::max<std::size_t>(length, 1);
      continue;
    }
    append_literal(stream, bytes.substr(literal, i - literal));
    append_repeat(stream, length);
    i += length;
    literal = i;
  }
  append_literal(stream, bytes.substr(std::min(literal, bytes.size())));
  return stream;
}

}  // namespace adit

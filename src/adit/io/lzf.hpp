// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// LZF, the byte compression inside PCD's binary_compressed.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "adit/core/result.hpp"

namespace adit {

/// Expands an LZF stream to exactly `size` bytes. Anything else (truncated run, reference before the start,
/// too few or too many bytes) is an error that names the byte offset in the stream.
///
/// The format is a sequence of
///  - literal runs: control byte c < 32, then c + 1 bytes to copy;
///  - back references: control byte with the length in its upper three bits (7: a further byte is added to
///  it) and the
///    upper five bits of the distance in the others, then the lower eight bits; length + 2 bytes are copied
///    from distance + 1 bytes back, possibly overlapping what is being written.
Result<std::string> expand_lzf(std::string_view stream, std::size_t size);

/// An LZF stream that expands to `bytes`, made of literal runs and of repetitions of the last byte.
[[nodiscard]] std::string compress_lzf(std::string_view bytes);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Random access to bytes, from a file or from memory, for files too large to hold.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include "adit/core/result.hpp"

namespace adit {

/// `read(offset, size)` gives exactly `size` bytes or an error that names the offset; it may be called from
/// any thread.
struct ByteSource {
  std::uint64_t size = 0;  ///< In bytes.
  /// Fails for what reaches past the end.
  std::function<Result<std::string>(std::uint64_t offset, std::uint64_t size)> read;
};

/// Keeps the file open as long as a copy of the source lives.
Result<ByteSource> open_source(const std::filesystem::path& path);
/// The bytes live as long as a copy of the source.
///@{
[[nodiscard]] ByteSource memory_source(std::string bytes);
[[nodiscard]] ByteSource memory_source(std::shared_ptr<const std::string> bytes);
///@}

}  // namespace adit

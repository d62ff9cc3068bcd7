// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstring>
#include <span>
#include <vector>

#include "adit/transport/wire.hpp"

namespace adit::test {

/// An altered message under a checksum that fits, so that a test gets past it.
inline std::vector<std::byte> resealed(std::vector<std::byte> bytes) {
  const std::size_t content = bytes.size() - sizeof(std::uint64_t);
  const std::uint64_t hash = checksum(std::span(bytes).first(content));
  std::memcpy(bytes.data() + content, &hash, sizeof(hash));
  return bytes;
}

}  // namespace adit::test

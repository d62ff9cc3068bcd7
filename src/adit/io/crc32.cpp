// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/crc32.hpp"

#include <zlib.h>

namespace adit {

std::uint32_t crc32(std::string_view bytes, std::uint32_t crc) {
  // Of no bytes at all a null pointer would ask zlib for its start value instead.
  if (bytes.empty()) return crc;
  return static_cast<std::uint32_t>(
      ::crc32_z(crc, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

}  // namespace adit

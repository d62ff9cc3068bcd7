// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// CRC-32 as in zip, PNG and MCAP (IEEE 802.3: reflected polynomial 0xEDB88320, start and end inverted).
#pragma once

#include <cstdint>
#include <string_view>

namespace adit {

/// Of `bytes` alone, or continued: crc32(b, crc32(a)) = crc32(a + b).
[[nodiscard]] std::uint32_t crc32(std::string_view bytes, std::uint32_t crc = 0);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/fleet/sync/protocol.hpp"

namespace adit {

/// The bytes of a message: little-endian, a version byte first, a checksum last. Numbers travel exactly, but
/// for the points and viewpoints of clouds (16-bit steps of 5 mm, so at most 163 m away along each axis:
/// farther points are left out, and no viewpoint may be farther), their intensities (a byte each, to 4 %
/// between 0.0011 and 93,000) and descriptor cells (a byte each).
[[nodiscard]] std::vector<std::byte> encode(const Message& message);

/// What the last eight bytes of a message hold: a hash of all bytes before them. It finds damage, not malice.
[[nodiscard]] std::uint64_t checksum(std::span<const std::byte> bytes);

/// Reads what `encode` wrote; cut, foreign or damaged bytes are an error that names the place, never a crash.
[[nodiscard]] Result<Message> decode(std::span<const std::byte> bytes);

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace adit {

/// "&", "<", ">" and both quotes as entities; control characters that XML forbids, and bytes that are not
/// UTF-8, become "?": safe as text and in attributes, of HTML and of SVG.
[[nodiscard]] std::string escaped(std::string_view text);

/// RFC 4648, with padding, in one line.
[[nodiscard]] std::string base64(std::string_view bytes);

/// Displayed characters of UTF-8 text, one per code point.
[[nodiscard]] std::size_t num_characters(std::string_view text);

}  // namespace adit

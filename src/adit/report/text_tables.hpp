// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "adit/evaluation/tables.hpp"

namespace adit {

/// Title, aligned columns under a rule, caption; for a terminal. Columns align by displayed characters, not
/// bytes.
[[nodiscard]] std::string text_of(const Table& table);
/// GitHub's Markdown: title in bold, table, caption in italics. Bars in cells are escaped.
[[nodiscard]] std::string markdown_of(const Table& table);
/// A <figure> with <figcaption>; everything escaped.
[[nodiscard]] std::string html_of(const Table& table);

/// "&", "<", ">", and both quotes as entities, control characters that XML forbids dropped: safe as text and
/// in attributes, of HTML and of SVG.
[[nodiscard]] std::string escaped(std::string_view text);

}  // namespace adit

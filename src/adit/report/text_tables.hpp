// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "adit/evaluation/tables.hpp"

namespace adit {

/// Title, aligned columns under a rule, caption; for a terminal. Columns align by displayed characters, not
/// bytes.
[[nodiscard]] std::string text_of(const Table& table);
/// GitHub's Markdown: title in bold, table, caption in italics. Bars in cells are escaped.
[[nodiscard]] std::string markdown_of(const Table& table);
/// A `<figure>` with `<figcaption>`; everything escaped.
[[nodiscard]] std::string html_of(const Table& table);

}  // namespace adit

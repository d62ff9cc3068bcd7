// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Comma-separated values after RFC 4180: the one place that writes and reads them. Rows end with "\n".
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "adit/core/result.hpp"

namespace adit {

/// The cells as one row. A cell with a comma, a quote or a line break is put in quotes, its quotes doubled.
[[nodiscard]] std::string csv_row(const std::vector<std::string>& cells);

/// A row of a text and where it stands.
struct CsvRow {
  std::vector<std::string> cells;  ///< Without the quotes around them; blanks are kept.
  std::size_t line = 1;            ///< Where the row starts in the text, counted from 1.
};
/// All rows but empty lines. "\r\n" ends a row too, and the last row may lack its end. Fails, with the line,
/// on a quote that is not closed and on text after a closing quote.
[[nodiscard]] Result<std::vector<CsvRow>> parse_csv(std::string_view text);

}  // namespace adit

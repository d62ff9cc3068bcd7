// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/csv.hpp"

#include <algorithm>

#include "adit/core/format.hpp"

namespace adit {
namespace {

std::string quoted(const std::string& cell) {
  if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
  std::string text = "\"";
  for (const char c : cell) {
    if (c == '"') text.push_back('"');
    text.push_back(c);
  }
  text.push_back('"');
  return text;
}

/// Takes cells off the front of a text.
class CsvScanner {
 public:
  explicit CsvScanner(std::string_view text) : text_(text) {}

  [[nodiscard]] bool at_end() const { return at_ == text_.size(); }
  [[nodiscard]] std::size_t line() const { return line_; }

  /// One row without its end.
  Result<CsvRow> row() {
    CsvRow row{{}, line_};
    do {
      Result<std::string> cell = peek() == '"' ? quoted_cell() : plain_cell();
      if (!cell) return tl::unexpected(cell.error());
      row.cells.push_back(std::move(*cell));
    } while (take(','));
    take('\r');
    take('\n');
    return row;
  }

 private:
  [[nodiscard]] char peek() const { return at_end() ? '\0' : text_[at_]; }
  bool take(char c) {
    if (at_end() || text_[at_] != c) return false;
    line_ += c == '\n' ? 1 : 0;
    ++at_;
    return true;
  }
  std::string plain_cell() {
    const std::size_t end = std::min(text_.find_first_of(",\n", at_), text_.size());
    std::string cell(text_.substr(at_, end - at_));
    at_ = end;
    if (peek() != ',' && cell.ends_with('\r')) cell.pop_back();
    return cell;
  }
  Result<std::string> quoted_cell() {
    const std::size_t start_line = line_;
    std::string cell;
    take('"');
    while (!at_end()) {
      if (take('"')) {
        if (peek() != '"') return closed(std::move(cell));
      }
      const char c = peek();
      take(c);
      cell += c;
    }
    return fail(format("line {}: a quote is not closed", start_line));
  }
  [[nodiscard]] Result<std::string> closed(std::string cell) const {
    const char next = peek();
    if (at_end() || next == ',' || next == '\r' || next == '\n') return cell;
    return fail(format("line {}: text after a closing quote", line_));
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

}  // namespace

std::string csv_row(const std::vector<std::string>& cells) {
  std::string row;
  for (const std::string& cell : cells) {
    if (&cell != &cells.front()) row.push_back(',');
    row.append(quoted(cell));
  }
  row.push_back('\n');
  return row;
}

Result<std::vector<CsvRow>> parse_csv(std::string_view text) {
  std::vector<CsvRow> rows;
  for (CsvScanner scanner(text); !scanner.at_end();) {
    Result<CsvRow> row = scanner.row();
    if (!row) return tl::unexpected(row.error());
    if (row->cells != std::vector<std::string>{""}) rows.push_back(std::move(*row));
  }
  return rows;
}

}  // namespace adit

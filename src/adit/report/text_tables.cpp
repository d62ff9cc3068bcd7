// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/report/text_tables.hpp"

#include <algorithm>

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/report/markup.hpp"

namespace adit {
namespace {

using Row = std::vector<std::string>;

void check(const Table& table) {
  std::size_t grouped = 0;
  for (const ColumnGroup& group : table.groups) grouped += group.columns;
  ADIT_CHECK(table.groups.empty() || grouped == table.header.size(), "column groups cover the header");
  for (const Row& row : table.rows) ADIT_CHECK(row.size() == table.header.size(), "one cell per column");
}

std::string padding(std::size_t width, const std::string& text) {
  return std::string(width - std::min(width, num_characters(text)), ' ');
}

/// The first column to the left, numbers to the right.
std::string aligned(const Row& row, const std::vector<std::size_t>& widths) {
  std::string line;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const std::string space = padding(widths[i], row[i]);
    line += i == 0 ? row[i] + space : format("  {}{}", space, row[i]);
  }
  while (line.ends_with(' ')) line.pop_back();
  return line + "\n";
}

std::size_t span_width(const std::vector<std::size_t>& widths, std::size_t first, std::size_t columns) {
  std::size_t width = 2 * (columns - 1);
  for (std::size_t i = first; i < first + columns; ++i) width += widths[i];
  return width;
}

/// As wide as the widest cell; the last column of a group also makes room for the group's title.
std::vector<std::size_t> column_widths(const Table& table) {
  std::vector<std::size_t> widths;
  for (const std::string& cell : table.header) widths.push_back(num_characters(cell));
  for (const Row& row : table.rows) {
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], num_characters(row[i]));
  }
  std::size_t first = 0;
  for (const ColumnGroup& group : table.groups) {
    const std::size_t width = span_width(widths, first, group.columns);
    widths[first + group.columns - 1] +=
        num_characters(group.title) - std::min(width, num_characters(group.title));
    first += group.columns;
  }
  return widths;
}

std::string group_line(const Table& table, const std::vector<std::size_t>& widths) {
  Row titles;
  std::vector<std::size_t> spans;
  std::size_t first = 0;
  for (const ColumnGroup& group : table.groups) {
    titles.push_back(group.title);
    spans.push_back(span_width(widths, first, group.columns));
    first += group.columns;
  }
  return aligned(titles, spans);
}

/// Lines of at most `width` characters, broken between words.
std::string wrapped(const std::string& text, std::size_t width) {
  std::string out;
  std::size_t column = 0;
  for (std::size_t first = 0; first < text.size();) {
    const std::size_t last = std::min(text.find(' ', first), text.size());
    const std::string word = text.substr(first, last - first);
    const std::size_t length = num_characters(word);
    if (column > 0) out += column + 1 + length > width ? '\n' : ' ';
    column = column > 0 && column + 1 + length <= width ? column + 1 + length : length;
    out += word;
    first = last + 1;
  }
  return out + "\n";
}

/// "Group: heading" for formats whose tables have one header row.
Row flat_header(const Table& table) {
  Row header = table.header;
  std::size_t column = 0;
  for (const ColumnGroup& group : table.groups) {
    for (std::size_t i = 0; i < group.columns; ++i, ++column) {
      if (!group.title.empty()) header[column] = group.title + ": " + header[column];
    }
  }
  return header;
}

std::string markdown_escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '*' || c == '<' || c == '\\') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out;
}

std::string markdown_row(const Row& row) {
  std::string line = "|";
  for (const std::string& cell : row) line += format(" {} |", markdown_escaped(cell));
  return line + "\n";
}

std::string html_group_row(const Table& table) {
  if (table.groups.empty()) return "";
  std::string row = "<tr>";
  for (const ColumnGroup& group : table.groups) {
    row += format("<th colspan=\"{}\" scope=\"colgroup\"{}>{}</th>", group.columns,
                  group.title.empty() ? "" : " class=\"group\"", escaped(group.title));
  }
  return row + "</tr>\n";
}

std::string html_cell(const std::string& cell) {
  const char* mark = cell == "✓"   ? " class=\"mark good\""
                     : cell == "✗" ? " class=\"mark bad\""
                     : cell == "○" ? " class=\"mark\""
                                   : "";
  return format("<td{}>{}</td>", mark, escaped(cell));
}

}  // namespace

std::string text_of(const Table& table) {
  check(table);
  const std::vector<std::size_t> widths = column_widths(table);
  const std::size_t full = widths.empty() ? 0 : span_width(widths, 0, widths.size());
  std::string rule;
  for (std::size_t i = 0; i < full; ++i) rule += "─";
  std::string text = table.title + "\n" + rule + "\n";
  if (!table.groups.empty()) text += group_line(table, widths);
  text += aligned(table.header, widths) + rule + "\n";
  for (const Row& row : table.rows) text += aligned(row, widths);
  return text + rule + "\n" + wrapped(table.caption, std::max<std::size_t>(full, 60));
}

std::string markdown_of(const Table& table) {
  check(table);
  std::string text = format("**{}**\n\n{}|", markdown_escaped(table.title), markdown_row(flat_header(table)));
  for (std::size_t i = 0; i < table.header.size(); ++i) text += i == 0 ? " :-- |" : " --: |";
  text += "\n";
  for (const Row& row : table.rows) text += markdown_row(row);
  return text + format("\n*{}*\n", markdown_escaped(table.caption));
}

std::string html_of(const Table& table) {
  check(table);
  std::string html = format(
      "<figure class=\"table\">\n<figcaption><b>{}.</b> {}</figcaption>\n<div "
      "class=\"scroll\"><table>\n<thead>\n{}<tr>",
      escaped(table.title), escaped(table.caption), html_group_row(table));
  for (const std::string& cell : table.header) html += format("<th scope=\"col\">{}</th>", escaped(cell));
  html += "</tr>\n</thead>\n<tbody>\n";
  for (const Row& row : table.rows) {
    html += "<tr>";
    for (const std::string& cell : row) html += html_cell(cell);
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table></div>\n</figure>\n";
}

}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/csv.hpp"

#include <gtest/gtest.h>

#include "support/files.hpp"

namespace adit {
namespace {

using Cells = std::vector<std::string>;

std::vector<Cells> cells_of(std::string_view text) {
  const std::vector<CsvRow> rows = parse_csv(text).value();
  std::vector<Cells> cells;
  for (const CsvRow& row : rows) cells.push_back(row.cells);
  return cells;
}

TEST(Csv, PlainCellsStayPlain) {
  EXPECT_EQ(csv_row({"robot_0", "1.5", "", "a b"}), "robot_0,1.5,,a b\n");
  EXPECT_EQ(csv_row({}), "\n");
}

TEST(Csv, WhatWouldBreakARowIsQuoted) {
  EXPECT_EQ(csv_row({"a,b", "say \"hi\"", "two\nlines", "c"}),
            "\"a,b\",\"say \"\"hi\"\"\",\"two\nlines\",c\n");
}

TEST(Csv, EveryRowIsReadBack) {
  const std::vector<Cells> rows = {{"a", "b"},       {"", ""},         {",", "\"", "\n"},
                                   {"\r\n", "x\ry"}, {"\"\"", "a\"b"}, {" leading", "ü,"},
                                   {"one"}};
  std::string text;
  for (const Cells& row : rows) text += csv_row(row);
  EXPECT_EQ(cells_of(text), rows);
}

TEST(Csv, OtherProgramsLineEndsAreRead) {
  EXPECT_EQ(cells_of("a,b\r\n\"c\",d\r\n\r\ne,f"), (std::vector<Cells>{{"a", "b"}, {"c", "d"}, {"e", "f"}}));
}

TEST(Csv, RowsKnowTheirLines) {
  const std::vector<CsvRow> rows = parse_csv("a\n\"b\nb\"\n\nc\n").value();
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[1].line, 2U);
  EXPECT_EQ(rows[2].line, 5U);
}

TEST(Csv, BrokenQuotesAreRefusedWithTheLine) {
  EXPECT_ERROR(parse_csv("a\n\"b,c\n"), "line 2: a quote is not closed");
  EXPECT_ERROR(parse_csv("a\n\"b\"c,d\n"), "line 2: text after a closing quote");
}

}  // namespace
}  // namespace adit

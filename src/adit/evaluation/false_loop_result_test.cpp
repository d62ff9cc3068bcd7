// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/false_loop_result.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

LoopScore score(int true_kept, int true_lost, int false_kept, int false_rejected) {
  return {true_kept, true_lost, false_kept, false_rejected};
}

TEST(LoopScore, CountsByLabelAndDecision) {
  LoopScore counted;
  for (int i = 0; i < 6; ++i) counted.add(true, i != 0);
  for (int i = 0; i < 4; ++i) counted.add(false, i == 0);
  EXPECT_EQ(counted, score(5, 1, 1, 3));
  EXPECT_EQ(counted.num_true(), 6);
  EXPECT_EQ(counted.num_false(), 4);
  EXPECT_DOUBLE_EQ(*counted.precision(), 5.0 / 6.0);
  EXPECT_DOUBLE_EQ(*counted.recall(), 5.0 / 6.0);
  counted += score(5, 0, 0, 9);
  EXPECT_EQ(counted, score(10, 1, 1, 12));
}

TEST(LoopScore, PrecisionIsOfThoseKeptAndRecallOfThoseTrue) {
  EXPECT_DOUBLE_EQ(*score(2, 6, 0, 5).precision(), 1.0);
  EXPECT_DOUBLE_EQ(*score(2, 6, 0, 5).recall(), 0.25);
  EXPECT_DOUBLE_EQ(*score(8, 0, 2, 0).precision(), 0.8);
  EXPECT_DOUBLE_EQ(*score(8, 0, 2, 0).recall(), 1.0);
}

TEST(LoopScore, HasNoPrecisionWhereNothingIsKeptAndNoRecallWhereNothingIsTrue) {
  EXPECT_FALSE(score(0, 3, 0, 3).precision());
  EXPECT_DOUBLE_EQ(*score(0, 3, 0, 3).recall(), 0.0);
  EXPECT_FALSE(score(0, 0, 1, 3).recall());
}

FalseLoopRun run(const std::string& graph, int share_pct, const std::string& injection = "random") {
  FalseLoopRun made;
  made.graph = graph;
  made.injection = injection;
  made.num_true = 1000;
  made.num_false = 10 * share_pct;
  made.share_pct = share_pct;
  made.decisions[0] = LoopDecision{score(900, 100, 1, 99), 1, 1, 0.25, 2.0, true};
  made.decisions[1] = LoopDecision{score(500, 500, 0, 100), 3, 1, 7.0, 0.5, false};
  made.decisions[2] = LoopDecision{score(9999, 0, 1, 99), 2, 2, 0.0, 0.125, true, 17};
  return made;
}
using Row = std::vector<std::string>;

TEST(FalseLoopTables, ShowTheMethodsSideBySide) {
  const std::vector<Table> tables = false_loop_tables({run("a", 50)});
  ASSERT_EQ(tables.size(), 2U);
  EXPECT_EQ(tables[1].rows.front(), (Row{"a",    "random", "50", "1000",    "500",   //
                                         "99.9", "90.0",   "0",  "0.250",   "2.00",  //
                                         "100",  "50.0 †", "0",  "3 parts", "0.50",  //
                                         "99.9", "100",    "17", "0.000",   "0.12"}));
  for (const Table& table : tables) {
    std::size_t grouped = 0;
    for (const ColumnGroup& group : table.groups) grouped += group.columns;
    EXPECT_EQ(grouped, table.header.size());
    for (const Row& row : table.rows) EXPECT_EQ(row.size(), table.header.size());
  }
}

TEST(FalseLoopTables, SumOnlyGraphsThatEveryMethodAnswers) {
  FalseLoopRun without = run("flat", 50);
  without.decisions[1].reset();
  without.reasons[1] = "the graph is 2-D";
  const std::vector<Table> tables =
      false_loop_tables({run("a", 50), run("b", 50), run("c", 10), run("d", 10, "clustered"),
                         run("e", 50, "as found"), without, without});
  ASSERT_EQ(tables.size(), 3U);
  ASSERT_EQ(tables[0].rows.size(), 3U);
  EXPECT_EQ(tables[0].rows[0].front(), "clustered");
  EXPECT_EQ(tables[0].rows[2], (Row{"random", "50", "2", "2000", "1000", "99.9", "90.0", "0", "100", "50.0",
                                    "2", "99.9", "100", "0"}));
  EXPECT_EQ(tables[1].rows.size(), 7U);
  ASSERT_EQ(tables[2].rows.size(), 1U);
  EXPECT_EQ(tables[2].rows[0], (Row{"flat", "PCM", "the graph is 2-D"}));
}

}  // namespace
}  // namespace adit

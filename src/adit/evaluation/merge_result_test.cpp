// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/merge_result.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "adit/core/check.hpp"

namespace adit {
namespace {

MergeEvidence evidence(double ate_m, int wrong_loops) {
  return {true, 10, wrong_loops, {{400.0, ate_m, 3.0}, {400.0, 0.5, 1.0}}};
}

TEST(JudgeMerge, ThePapersRuleDecidesSuccess) {
  EXPECT_EQ(judge_merge(evidence(3.9, 0)), MergeOutcome::success);
  EXPECT_EQ(judge_merge(evidence(4.1, 0)), MergeOutcome::bent);
  MergeEvidence apart = evidence(3.9, 0);
  apart.merged = false;
  EXPECT_EQ(judge_merge(apart), MergeOutcome::refused);
}

TEST(JudgeMerge, AWrongPlaceIsSeparatedFromDrift) {
  EXPECT_EQ(judge_merge(evidence(5.4, 0)), MergeOutcome::bent);
  EXPECT_EQ(judge_merge(evidence(5.6, 0)), MergeOutcome::wrong);
  EXPECT_EQ(judge_merge(evidence(5.0, 4)), MergeOutcome::bent);
  EXPECT_EQ(judge_merge(evidence(5.0, 5)), MergeOutcome::wrong);
}

TEST(JudgeMerge, OutcomesHaveNames) {
  for (const MergeOutcome outcome :
       {MergeOutcome::success, MergeOutcome::bent, MergeOutcome::refused, MergeOutcome::wrong})
    EXPECT_EQ(merge_outcome(to_string(outcome)), outcome);
  EXPECT_THROW((void)merge_outcome("perhaps"), ContractViolation);
}

MergePair pair_of(double shared_m, MergeOutcome outcome, double distinctive_m = 30.0) {
  MergePair pair;
  pair.robots = {"robot_0", "robot_1"};
  pair.shared_m = shared_m;
  pair.distinctive_m = distinctive_m;
  pair.outcome = outcome;
  pair.refused_reason = outcome == MergeOutcome::refused ? "the tunnel was too smooth" : "";
  return pair;
}

MergeRun made_up_run(const std::string& world, const std::string& group) {
  MergeRun run;
  run.world = world;
  run.group = group;
  run.keyframes = "all";
  run.pairs = {pair_of(90.0, MergeOutcome::success),   pair_of(60.0, MergeOutcome::refused),
               pair_of(30.0, MergeOutcome::wrong),     pair_of(0.0, MergeOutcome::refused),
               pair_of(12.0, MergeOutcome::wrong),     pair_of(80.0, MergeOutcome::bent, 0),
               pair_of(80.0, MergeOutcome::refused, 0)};
  run.joint.maps = {{"robot_0", "robot_1"}, {"robot_2"}};
  run.joint.possible_maps = {{"robot_0", "robot_1", "robot_2"}};
  run.registrations = 500;
  return run;
}

TEST(MergeCounts, PairsAreCountedByWhatTheyShare) {
  MergeCounts counts;
  counts.add(made_up_run("a", "tuning"));
  counts.add(made_up_run("b", "tuning"));
  EXPECT_EQ(counts.worlds, 2);
  EXPECT_EQ(counts.mergeable, 6);
  EXPECT_EQ(counts.success, 2);
  EXPECT_EQ(counts.refused, 2);
  EXPECT_EQ(counts.indistinct, 4);
  EXPECT_EQ(counts.indistinct_merged, 2);
  EXPECT_EQ(counts.others, 4);
  EXPECT_EQ(counts.kept_apart, 2);
  EXPECT_EQ(counts.wrong, 4);
  EXPECT_EQ(counts.joint_whole, 0);
  EXPECT_EQ(counts.joint_merged, 6);  // all of them between robots 0 and 1
  EXPECT_EQ(counts.pairs, 14);
  EXPECT_EQ(counts.merged, 8);
  EXPECT_EQ(counts.joint_pairs, 14);
  EXPECT_EQ(counts.refusals[static_cast<std::size_t>(RefusalKind::unknown)], 2);
  EXPECT_EQ(counts.registrations, 1000);
}

TEST(MergeTables, NameEveryRefusalAndEveryWrongMerge) {
  const std::vector<Table> tables = merge_tables({made_up_run("a", "tuning"), made_up_run("b", "check")});
  ASSERT_EQ(tables.size(), 5U);
  for (const Table& table : tables)
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.header.size()) << table.title;
  EXPECT_EQ(tables[0].rows.size(), 2U);  // One per group.
  EXPECT_EQ(tables[1].rows.size(), 2U);
  EXPECT_EQ(tables[1].rows[0][12], "0+1 2 (0+1+2)");
  EXPECT_EQ(tables[2].rows.size(), 2U);
  EXPECT_EQ(tables[2].rows[0].back(), "0+1 (30 m shared, 0 m off), 0+1 (12 m shared, 0 m off)");
  EXPECT_EQ(tables[3].rows.size(), 2U);  // What kept them apart, of the mergeable ones.
  EXPECT_EQ(tables[3].rows[0][4], "1");
  const auto unknown = std::ranges::find(tables[3].header, "unknown") - tables[3].header.begin();
  ASSERT_LT(unknown, std::ssize(tables[3].header));
  EXPECT_EQ(tables[3].rows[0][static_cast<std::size_t>(unknown)], "1");
  EXPECT_EQ(tables[4].rows.size(), 4U);
  EXPECT_EQ(tables[4].rows[0].back(), "the tunnel was too smooth");
}

TEST(MergeCounts, AMapThatHoldsMoreThanMergeablePairsWouldJoinIsWhole) {
  MergeRun run = made_up_run("a", "tuning");
  run.joint.maps = {{"robot_0", "robot_1", "robot_2"}};
  run.joint.possible_maps = {{"robot_0", "robot_1"}, {"robot_2"}};
  MergeCounts counts;
  counts.add(run);
  EXPECT_EQ(counts.joint_whole, 1);
  EXPECT_EQ(counts.joint_merged, 3);
  run.joint.wrong = true;
  counts.add(run);
  run.joint.wrong = false;
  run.joint.maps = {{"robot_0"}, {"robot_1", "robot_2"}};
  counts.add(run);
  EXPECT_EQ(counts.joint_whole, 1);
  EXPECT_EQ(counts.joint_merged, 3);
}

TEST(MergeTables, ShowOnlyTheSumsAndTheWrongMergesOfVariants) {
  MergeRun variant = made_up_run("a", "tuning");
  variant.keyframes = "all without relief";
  const std::vector<Table> tables = merge_tables({made_up_run("a", "tuning"), variant});
  EXPECT_EQ(tables[0].rows.size(), 2U);
  EXPECT_EQ(tables[1].rows.size(), 1U);
  EXPECT_EQ(tables[2].rows.size(), 2U);
  EXPECT_EQ(tables[4].rows.size(), 2U);
}

TEST(MergeTables, SumUpSensorsAndConditionsApartWithTheirLimits) {
  MergeRun field = made_up_run("a", "tuning");
  field.sensors = "os2-32, os1-64";
  field.conditions = "field";
  const std::vector<Table> tables = merge_tables({made_up_run("a", "tuning"), field, field});
  ASSERT_EQ(tables[0].rows.size(), 2U);
  EXPECT_EQ(tables[0].rows[1][2], "os2-32, os1-64");
  EXPECT_EQ(tables[0].rows[1][3], "field");
  EXPECT_EQ(tables[0].rows[1][4], "2");
  EXPECT_EQ(tables[0].rows[1][5], "2 of 6 (33 %; 4 to 78)");
  EXPECT_EQ(tables[0].rows[1][10], "4 of 14 (< 54.0 %)");
}

TEST(MergeTables, SumUpByTheSensorsOfAPair) {
  MergeRun run = made_up_run("a", "field");
  run.sensors = "os2-32, vlp-16";  // of robots 0 and 2, and of robot 1
  run.pairs = {pair_of(90.0, MergeOutcome::success), pair_of(90.0, MergeOutcome::refused),
               pair_of(90.0, MergeOutcome::success)};
  run.pairs[1].robots = {"robot_0", "robot_2"};
  run.pairs[2].robots = {"robot_1", "robot_2"};
  const std::vector<Table> tables = merge_tables({run});
  const auto found = std::ranges::find(tables, "Merging, by the sensors of a pair", &Table::title);
  ASSERT_NE(found, tables.end());
  ASSERT_EQ(found->rows.size(), 3U);
  EXPECT_EQ(found->rows[0][3], "os2-32 and vlp-16");
  EXPECT_TRUE(found->rows[0][5].starts_with("2 of 2")) << found->rows[0][5];
  EXPECT_TRUE(found->rows[0][6].starts_with("1 of 2")) << "robot_2 stayed apart: " << found->rows[0][6];
  EXPECT_EQ(found->rows[1][3], "os2-32 both");
  EXPECT_TRUE(found->rows[1][5].starts_with("0 of 1")) << found->rows[1][5];
  EXPECT_EQ(found->rows[2][3], "all");
  EXPECT_TRUE(found->rows[2][5].starts_with("2 of 3")) << found->rows[2][5];
}

TEST(MergeTables, LeaveOutWhatDidNotHappen) {
  MergeRun run = made_up_run("a", "tuning");
  run.pairs = {pair_of(90.0, MergeOutcome::success)};
  EXPECT_EQ(merge_tables({run}).size(), 2U);
}

}  // namespace
}  // namespace adit

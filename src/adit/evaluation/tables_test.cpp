// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/tables.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace adit {
namespace {

AteResult made_up_ate(double max_m) {
  AteResult ate;
  ate.errors_m = {0.5 * max_m, max_m};
  ate.max_m = max_m;
  ate.rmse_m = 0.8 * max_m;
  ate.median_m = 0.75 * max_m;
  return ate;
}

PairResult made_up_pair(const std::string& keyframes, bool pcm) {
  PairResult pair;
  pair.robots = {MergedRobot{"robot_0", 400.0, made_up_ate(0.3)},
                 MergedRobot{"robot_1", 300.0, made_up_ate(2.9)}};
  pair.keyframes = keyframes;
  pair.pcm = pcm;
  pair.merged = true;
  pair.loops_before_pcm = {200, 93, 74};
  pair.loops_after_pcm = {12, 0, 1};
  return pair;
}

StudyResult made_up_study() {
  StudyResult study;
  study.robots = {
      RobotResult{"robot_0", 400.0, 200.0, 2000, 800, {{"kiss_icp", made_up_ate(30.0), 12.0}}, {}},
      RobotResult{"robot_1", 300.0, 200.0, 2000, 600, {{"kinematic_icp", std::nullopt, std::nullopt}}, {}}};
  for (const bool pcm : {false, true}) {
    study.pairs.push_back(made_up_pair("tunnel_filter", pcm));
    study.pairs.push_back(made_up_pair("all", pcm));
  }
  study.joint = JointResult{};
  study.joint->components = {{"robot_0"}, {"robot_1"}};
  study.joint->robots = {study.pairs[0].robots[0], study.pairs[0].robots[1]};
  return study;
}

void expect_rectangular(const Table& table) {
  for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.header.size()) << table.title;
  const std::size_t grouped =
      std::accumulate(table.groups.begin(), table.groups.end(), std::size_t{0},
                      [](std::size_t n, const ColumnGroup& g) { return n + g.columns; });
  EXPECT_TRUE(table.groups.empty() || grouped == table.header.size()) << table.title;
}

TEST(Tables, AllAreRectangularWithAndWithoutThePaper) {
  for (const PaperFigures paper : {PaperFigures::hide, PaperFigures::show}) {
    const std::vector<Table> tables = study_tables(made_up_study(), paper);
    EXPECT_EQ(tables.size(), 7U);
    for (const Table& table : tables) expect_rectangular(table);
  }
  for (const Table& table : study_tables(StudyResult{}, PaperFigures::show)) expect_rectangular(table);
}

TEST(Tables, OutliersStandBesideThePapers) {
  const Table before = outliers_before_pcm_table(made_up_study(), PaperFigures::show);
  const std::vector<std::string> expected = {"(0, 1)", "46.50", "37.00", "46.50", "37.00",
                                             "46.08",  "37.30", "33.33", "-"};
  ASSERT_EQ(before.rows.size(), 1U);
  EXPECT_EQ(before.rows[0], expected);
  const Table after = outliers_after_pcm_table(made_up_study());
  EXPECT_EQ(after.rows[0], (std::vector<std::string>{"(0, 1)", "-", "8.33", "-", "8.33"}));
}

TEST(Tables, SuccessNeedsAMergeAndOnePerCent) {
  StudyResult study = made_up_study();
  EXPECT_TRUE(study.pairs[0].success());            // 2.9 of 300 m
  study.pairs[0].robots[1].ate = made_up_ate(3.1);  // tunnel_filter, no PCM
  EXPECT_FALSE(study.pairs[0].success());
  study.pairs[1].merged = false;  // all, no PCM
  EXPECT_FALSE(study.pairs[1].success());
  study.pairs[2].robots[0].ate.reset();  // tunnel_filter, PCM
  EXPECT_FALSE(study.pairs[2].success());
  const Table table = success_table(study, PaperFigures::show);
  ASSERT_EQ(table.rows.size(), 2U);
  EXPECT_EQ(table.rows[0], (std::vector<std::string>{"(0, 1)", "no", "○", "✗", "✗", "✗"}));
  EXPECT_EQ(table.rows[1], (std::vector<std::string>{"(0, 1)", "yes", "✓", "✗", "✗", "✓"}));
}

TEST(Tables, LargestAteAndRefusedPairs) {
  StudyResult study = made_up_study();
  study.pairs[3].merged = false;  // all, PCM
  const Table table = max_ate_table(study, PaperFigures::show);
  EXPECT_EQ(table.rows[0],
            (std::vector<std::string>{"(0, 1)", "0.300 ○", "2.900 ○", "0.300", "2.900", "0.291", "0.358"}));
}

TEST(Tables, UnknownRobotsHaveNoPaperFigures) {
  StudyResult study = made_up_study();
  study.robots[0].name = "husky";
  for (PairResult& pair : study.pairs) pair.robots[0].name = "husky";
  EXPECT_EQ(trajectories_table(study, PaperFigures::show).rows[0].back(), "");
  const Table table = max_ate_table(study, PaperFigures::show);
  EXPECT_EQ(table.rows[0].front(), "(husky, 1)");
  EXPECT_EQ(table.rows[0].back(), "");
}

TEST(Tables, FindPairKnowsNamesPolicyAndPcm) {
  const StudyResult study = made_up_study();
  EXPECT_EQ(find_pair(study, {"robot_0", "robot_1"}, "all", true), &study.pairs[3]);
  EXPECT_EQ(find_pair(study, {"robot_1", "robot_0"}, "all", true), nullptr);
  EXPECT_EQ(find_pair(study, {"robot_0", "robot_1"}, "adaptive", true), nullptr);
}

}  // namespace
}  // namespace adit

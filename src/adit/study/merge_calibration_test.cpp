// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/merge_calibration.hpp"

#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/short_drives.hpp"

namespace adit {
namespace {

constexpr double kNeeded = 6.9;

std::vector<JudgedHypothesis> made_up() {
  std::vector<JudgedHypothesis> all(90, {HypothesisTruth::wrong, true, false, 0.0, kNeeded});
  for (const double evidence : {-3.0, 0.5, 2.5, 7.5})
    all.push_back({HypothesisTruth::wrong, false, false, evidence, kNeeded});
  all.push_back({HypothesisTruth::near, false, false, 7.0, kNeeded});
  for (const double evidence : {1.5, 8.0, 30.0})
    all.push_back({HypothesisTruth::right, false, evidence > kNeeded, evidence, kNeeded});
  all.push_back({HypothesisTruth::right, true, false, 0.0, kNeeded});
  return all;
}

TEST(MergeCalibration, RefutedHypothesesCountAsRejected) {
  const std::vector<Table> tables = calibration_tables(made_up());
  ASSERT_EQ(tables.size(), 2U);
  for (const Table& table : tables)
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.header.size());
  const auto& rates = tables[0].rows;
  EXPECT_EQ(rates[0][2].substr(0, 7), "3 of 94") << "their evidence of 0 does not reach 0";
  EXPECT_EQ(rates[7][0], "6.9 (needed)");
  EXPECT_EQ(rates[7][1], "0.001");
  EXPECT_EQ(rates[7][2].substr(0, 7), "1 of 94");
  EXPECT_EQ(rates[7][3], "2 of 4 (50 %)");
  EXPECT_EQ(rates.back()[2].substr(0, 7), "0 of 94");
  EXPECT_EQ(rates.back()[3], "2 of 4 (50 %)");
}

TEST(MergeCalibration, EveryHypothesisIsInOneBin) {
  const Table bins = calibration_tables(made_up())[1];
  std::array<int, 3> sums{};
  for (const auto& row : bins.rows)
    for (std::size_t k = 0; k < 3; ++k) sums[k] += std::stoi(row[k + 1]);
  EXPECT_EQ(sums, (std::array{4, 1, 94}));
  EXPECT_EQ(calibration_tables({})[1].rows.front().back(), "-");
}

TEST(MergeCalibration, NoHypothesisBetweenWorldsIsRight) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "maps");
  const ListedWorld world = test::put_short_drives(folder.path());
  ListedWorld other = world;
  other.name = "another";
  other.noise_seed = 9;
  const CalibrationStudy study{test::quick_config(), folder.path()};
  const auto within = hypotheses_within(study, world);
  ASSERT_TRUE(within) << within.error().message;
  // The same hall in truth, so that alignments are found; as another world they are wrong all the same.
  const auto between = hypotheses_between(study, world, other);
  ASSERT_TRUE(between) << between.error().message;
  for (const JudgedHypothesis& h : *between) EXPECT_EQ(h.truth, HypothesisTruth::wrong);
  EXPECT_FALSE(calibration_json(*between).empty());
  ListedWorld gone = world;
  gone.routes_file = (folder / "gone.yaml").string();
  EXPECT_ERROR(hypotheses_between(study, world, gone), "gone.yaml");
}

}  // namespace
}  // namespace adit

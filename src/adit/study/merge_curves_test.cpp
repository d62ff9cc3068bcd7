// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/merge_curves.hpp"

#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/short_drives.hpp"

namespace adit {
namespace {

const MergeEffect kBias{.name = "bias",
                        .field = "simulation.lidar_errors.range_bias",
                        .unit = "m",
                        .stated = 0.03,
                        .steps = 2,
                        .set = "simulation.lidar_errors.opposed=true"};

TEST(MergeEffects, AreReadAndCheckedAgainstTheConfiguration) {
  const test::TemporaryFolder folder;
  const auto effects_of = [&](const std::string& toml) {
    test::put_file(folder / "effects.toml", toml);
    return read_effects(folder / "effects.toml");
  };
  const std::string people =
      "[[effect]]\nname = 'people'\nfield = 'simulation.visits.people'\nstated = 4\nsteps = 4\n";
  const auto effects = effects_of(people);
  ASSERT_TRUE(effects) << effects.error().message;
  EXPECT_EQ(effects->at(0).amplitudes(), (std::vector<double>{0, 2, 4, 6, 8}));
  EXPECT_ERROR(effects_of(people + people), "effects.toml: two effects are called 'people'");
  EXPECT_ERROR(effects_of("[[effect]]\nname = 'a'\nfield = 'simulation.lidar_errors.bias'\nstated = 1\n"),
               "'a'");
  EXPECT_ERROR(effects_of("[[effect]]\nname = 'a'\nfield = 'simulation.visits.people'\nstated = 0.3\n"),
               "'a'");
  EXPECT_ERROR(effects_of("[[effect]]\nfield = 'simulation.visits.dust'\n"), "no name");
}

TEST(MergeEffects, ChangeNothingAtZero) {
  const Result<RunConfig> none = with_effect(kBias, 0.0, RunConfig());
  ASSERT_TRUE(none);
  EXPECT_FALSE(none->simulation.lidar_errors.opposed);
  const Result<RunConfig> some = with_effect(kBias, 0.03, RunConfig());
  ASSERT_TRUE(some) << some.error().message;
  EXPECT_EQ(some->simulation.lidar_errors.range_bias, 0.03);
  EXPECT_TRUE(some->simulation.lidar_errors.opposed);
}

CurvePoint point_of(double amplitude, int merged, int wrong) {
  CurvePoint point{"bias", amplitude, {}};
  point.counts.mergeable = 4;
  point.counts.success = merged;
  point.counts.refused = 4 - merged;
  point.counts.wrong = wrong;
  return point;
}

TEST(MergeCurves, TablesSayWhereMergesBeginToBeRefused) {
  const std::vector<CurvePoint> points = {point_of(0.0, 3, 0), point_of(0.03, 3, 0), point_of(0.06, 2, 0)};
  const std::vector<Table> tables = curve_tables({kBias}, points);
  ASSERT_EQ(tables.size(), 2U);
  EXPECT_EQ(tables[0].rows[0], (std::vector<std::string>{"bias", "0.03 m", "0.06 m", "none", "none"}));
  EXPECT_EQ(tables[1].rows[2],
            (std::vector<std::string>{"bias", "0.06 m", "2", "2 of 4", "0", "2", "0", "0 of 4", "0"}));
  EXPECT_NE(curves_plot({kBias}, points).find("<svg"), std::string::npos);
}

TEST(MergeCurves, ResultsAreKeptAndMapsAreNot) {
  const test::TemporaryFolder folder;
  const ListedWorld world = test::put_short_drives(folder.path());
  MergeStudy study;
  study.config = test::quick_config();
  study.folder = folder / "out";
  int num_run = 0;
  study.on_run = [&](const MergeRun&) { ++num_run; };
  MergeEffect dust = kBias;
  dust.name = "dust";
  dust.field = "simulation.visits.dust";
  dust.steps = 1;
  std::vector<MergeRun> runs;
  const auto points = measure_curves(study, {world}, {kBias, dust}, runs);
  ASSERT_TRUE(points) << points.error().message;
  ASSERT_EQ(points->size(), 5U);
  for (const CurvePoint& point : *points) EXPECT_EQ(point.counts.pairs, 1) << point.effect << point.amplitude;
  EXPECT_EQ(num_run, 4) << "the run without effects serves both";
  EXPECT_EQ(test::num_entries(folder / "out/maps"), 1U);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/passing"));
  Result<std::vector<MergeRun>> kept = read_merge_runs(folder / "out/results.json");
  ASSERT_TRUE(kept) << kept.error().message;
  ASSERT_TRUE(measure_curves(study, {world}, {kBias, dust}, *kept));
  EXPECT_EQ(num_run, 4) << "nothing is run again";
  ASSERT_EQ(kept->size(), 4U);
  kept->front().sensors = "another";
  ASSERT_TRUE(measure_curves(study, {world}, {kBias, dust}, *kept));
  EXPECT_EQ(num_run, 5) << "a run with other sensors is not taken for one with these";
  EXPECT_EQ(kept->size(), 5U) << "and is kept beside it";
}

}  // namespace
}  // namespace adit

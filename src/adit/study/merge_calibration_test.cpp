// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/merge_calibration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "adit/report/rate_plot.hpp"
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

/// The step that holds at an evidence.
CalibrationStep step_at(const std::vector<CalibrationStep>& steps, double evidence) {
  const double claimed = std::exp(-evidence);
  const auto found =
      std::ranges::find_if(steps, [&](const CalibrationStep& step) { return step.to <= claimed; });
  return found == steps.end() ? CalibrationStep{} : *found;
}

TEST(CalibrationSteps, FallAlongTheAxisAndLieBelowTheirLimit) {
  for (const HypothesisTruth truth : {HypothesisTruth::right, HypothesisTruth::wrong}) {
    const std::vector<CalibrationStep> steps = calibration_steps(made_up(), truth);
    double from = 1.0;
    double share = 1.0;
    double limit = 1.0;
    for (const CalibrationStep& step : steps) {
      EXPECT_EQ(step.from, from) << "no gap";
      EXPECT_LE(step.to, step.from);
      EXPECT_LE(step.share(), share);
      EXPECT_LE(step.upper_limit(), limit);
      EXPECT_GT(step.upper_limit(), step.share());
      from = step.to;
      share = step.share();
      limit = step.upper_limit();
    }
    EXPECT_EQ(from, kLeastRate);
  }
}

TEST(CalibrationSteps, CountWhatTheTableCounts) {
  const std::vector<JudgedHypothesis> all = made_up();
  const std::vector<CalibrationStep> wrong = calibration_steps(all, HypothesisTruth::wrong);
  const std::vector<CalibrationStep> right = calibration_steps(all, HypothesisTruth::right);
  ASSERT_EQ(wrong.size(), 4U) << "reached by 3, 2, 1 and none";
  EXPECT_EQ(wrong.back().num_reached, 0U);
  EXPECT_EQ(right.back().num_reached, 1U) << "an evidence of 30 lies beyond the axis";
  for (const double evidence : {0.0, 0.4, 1.0, 2.4, 3.0, kNeeded, 7.4, 8.0, 11.0}) {
    const auto num = [&](HypothesisTruth truth) {
      return static_cast<std::size_t>(std::ranges::count_if(all, [&](const JudgedHypothesis& h) {
        return h.truth == truth && !h.refuted && h.evidence >= evidence;
      }));
    };
    EXPECT_EQ(step_at(wrong, evidence).num_reached, num(HypothesisTruth::wrong)) << evidence;
    EXPECT_EQ(step_at(wrong, evidence).num, 94U);
    EXPECT_EQ(step_at(right, evidence).num_reached, num(HypothesisTruth::right)) << evidence;
    EXPECT_EQ(step_at(right, evidence).num, 4U);
  }
}

TEST(CalibrationSteps, EqualAndZeroEvidenceMakeOneStep) {
  std::vector<JudgedHypothesis> all(3, {HypothesisTruth::wrong, false, false, 0.0, kNeeded});
  all.resize(5, {HypothesisTruth::wrong, false, false, 2.0, kNeeded});
  const std::vector<CalibrationStep> steps = calibration_steps(all, HypothesisTruth::wrong);
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_EQ(steps[0].share(), 1.0) << "all reach 0, and none of the three anything more";
  EXPECT_EQ(steps[0].upper_limit(), 1.0);
  EXPECT_EQ(steps[0].to, 1.0);
  EXPECT_EQ(steps[1].num_reached, 2U);
  EXPECT_EQ(steps[2].num_reached, 0U);
  EXPECT_TRUE(calibration_steps(all, HypothesisTruth::right).empty());
}

std::size_t num_lines(const std::string& svg) {
  const std::string line = "fill=\"none\" stroke-linejoin";
  std::size_t count = 0;
  for (std::size_t at = svg.find(line); at != std::string::npos; at = svg.find(line, at + 1)) ++count;
  return count;
}

TEST(CalibrationPlot, HasTheObservedShareItsLimitAndTheTrueOnes) {
  std::vector<JudgedHypothesis> all = made_up();
  const std::string svg = calibration_plot(all);
  EXPECT_EQ(num_lines(svg), 3U);
  for (const char* text :
       {"94 false and 4 true hypotheses; limits treat hypotheses as independent", ">false, observed<",
        ">false, upper limit (95 %)<", ">true, observed<", ">claimed = observed<",
        ">error rate in use: 0.001<", "claimed rate of wrong acceptance", "observed share"})
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  std::ranges::reverse(all);
  EXPECT_EQ(calibration_plot(all), svg) << "order does not matter";
}

TEST(CalibrationPlot, SaysWhatItLacks) {
  const std::string nothing = calibration_plot({});
  EXPECT_NE(nothing.find(">no false hypotheses<"), std::string::npos);
  EXPECT_NE(nothing.find("0 false and 0 true hypotheses"), std::string::npos);
  EXPECT_NE(nothing.find(">error rate in use: 0.002<"), std::string::npos);
  EXPECT_EQ(nothing.find("nan"), std::string::npos);
  EXPECT_EQ(num_lines(nothing), 0U);
  const std::vector<JudgedHypothesis> refuted(5, {HypothesisTruth::wrong, true, false, 0.0, kNeeded});
  const std::string limit = calibration_plot(refuted);
  EXPECT_EQ(num_lines(limit), 1U) << "none reaches any evidence; the limit of that is known";
  EXPECT_EQ(limit.find(">no false hypotheses<"), std::string::npos);
}

/// Some hypotheses about one pair of robots, with every number that is written.
std::vector<JudgedHypothesis> hypotheses_about(const std::string& robots) {
  std::vector<JudgedHypothesis> all = made_up();
  for (JudgedHypothesis& h : all) h.robots = robots;
  all.front().walls = -0.1;
  all.front().counts = {1, 2, 3, 4, 8.1, 0.25, 0.125};
  return all;
}

TEST(JoinedCalibrations, AreWhatTheRunsWrote) {
  const test::TemporaryFolder folder;
  const std::string first = (folder / "first.json").string();
  const std::string second = (folder / "second.json").string();
  test::put_file(first, calibration_json(hypotheses_about("a/0, a/1")));
  test::put_file(second, calibration_json(hypotheses_about("a/0, b/0")));
  const auto one = read_calibration(first);
  ASSERT_TRUE(one) << one.error().message;
  EXPECT_EQ(calibration_json(*one), calibration_json(hypotheses_about("a/0, a/1")));
  EXPECT_EQ(one->front().counts, hypotheses_about("").front().counts);
  const auto both = joined_calibrations({first, second});
  ASSERT_TRUE(both) << both.error().message;
  EXPECT_EQ(both->size(), 2 * made_up().size());
  EXPECT_EQ(both->back().robots, "a/0, b/0");
  const auto none = joined_calibrations({});
  ASSERT_TRUE(none);
  EXPECT_TRUE(none->empty());
}

TEST(JoinedCalibrations, RefuseWhatWouldCountTwiceOrIsOfAnotherRun) {
  const test::TemporaryFolder folder;
  const std::string first = (folder / "first.json").string();
  const std::string other = (folder / "other.json").string();
  test::put_file(first, calibration_json(hypotheses_about("a/0, a/1")));
  EXPECT_ERROR(joined_calibrations({first, first}), "about a/0, a/1, too");
  test::put_file(other, calibration_json(hypotheses_about("a/1, a/0")));
  EXPECT_ERROR(joined_calibrations({first, other}), "about a/1, a/0, too");
  std::vector<JudgedHypothesis> stricter = hypotheses_about("b/0, b/1");
  for (JudgedHypothesis& h : stricter) h.needed = 9.2;
  test::put_file(other, calibration_json(stricter));
  EXPECT_ERROR(joined_calibrations({first, other}), "other.json: 9.20 of evidence was needed, 6.90 in");
  EXPECT_ERROR(joined_calibrations({first, (folder / "gone.json").string()}), "gone.json");
}

TEST(JoinedCalibrations, SayWhatIsWrongWithAFileAndWhere) {
  const test::TemporaryFolder folder;
  const std::string file = (folder / "other.json").string();
  const auto expect_refused = [&](const std::string& text, const std::string& fault) {
    test::put_file(file, text);
    EXPECT_ERROR(read_calibration(file), "other.json: " + fault);
  };
  const auto with = [](const std::string& old, const std::string& changed) {
    std::string text = calibration_json(hypotheses_about("a/0, a/1"));
    const std::size_t second = text.find(old, text.find(old) + old.size());
    return text.replace(second, old.size(), changed);
  };
  const std::string whole = calibration_json(hypotheses_about("a/0, a/1"));
  expect_refused("{\"version\": 2, \"hypotheses\": []}", "no hypotheses of this version; give");
  for (const std::string& damaged : {std::string(), whole.substr(0, 500)})
    expect_refused(damaged, "no calibration.json of merge-calibration, or a damaged one: ");
  expect_refused("{\"version\": 1}", "no calibration.json of merge-calibration, or a damaged one: ");
  expect_refused(with("\"truth\": \"wrong\"", "\"truth\": \"maybe\""), "hypothesis 1: truth is 'maybe', not");
  expect_refused(with("\"evidence\": 0.0", "\"evidence\": \"0\""), "hypothesis 1: ");
  expect_refused(with("\"needed\"", "\"wanted\""), "hypothesis 1: ");
  std::vector<JudgedHypothesis> endless = hypotheses_about("c/0, c/1");
  endless[2].evidence = std::numeric_limits<double>::infinity();
  expect_refused(calibration_json(endless), "hypothesis 2: ");
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

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/merge_run.hpp"

#include <gtest/gtest.h>

#include "adit/io/csv.hpp"
#include "adit/slam/slam_config.hpp"
#include "support/files.hpp"
#include "support/two_robots.hpp"

namespace adit {
namespace {

using test::get_file;
using test::put_file;

MergeRun empty_run(const std::string& world, const std::string& keyframes, int registrations = 0) {
  MergeRun run;
  run.world = world;
  run.keyframes = keyframes;
  run.registrations = registrations;
  return run;
}

/// A run with every field filled.
MergeRun made_up_run(const std::string& world, const std::string& keyframes) {
  MergeRun run = empty_run(world, keyframes, 99);
  run.group = "check";
  run.sensors = "os2-32, vlp-16";
  run.conditions = "field";
  for (const MergeOutcome outcome :
       {MergeOutcome::success, MergeOutcome::bent, MergeOutcome::refused, MergeOutcome::wrong})
    run.pairs.push_back({.robots = {"ada", "bo"},
                         .shared_m = 100.0 / 3.0,
                         .distinctive_m = 45.0,
                         .outcome = outcome,
                         .refused_kind = RefusalKind::rival,
                         .refused_reason = "one \"loop\", no more",
                         .registrations = 12,
                         .loops_in_use = 7,
                         .wrong_loops_in_use = 2,
                         .ate_max_m = {0.1, 0.2},
                         .ate_max_over_path_pct = {1.0 / 7.0, 2.5}});
  run.joint = {.maps = {{"ada", "bo"}, {"cy"}},
               .possible_maps = {{"ada", "bo", "cy"}},
               .wrong = true,
               .wrong_loops_in_use = 3,
               .ate_max_m = 1.25,
               .ate_max_over_path_pct = 0.3};
  run.time_s = 12.0625;
  return run;
}

void expect_equal(const MergePair& a, const MergePair& b) {
  EXPECT_EQ(a.robots, b.robots);
  EXPECT_EQ(a.shared_m, b.shared_m);
  EXPECT_EQ(a.distinctive_m, b.distinctive_m);
  EXPECT_EQ(a.outcome, b.outcome);
  EXPECT_EQ(a.refused_kind, b.refused_kind);
  EXPECT_EQ(a.refused_reason, b.refused_reason);
  EXPECT_EQ(a.registrations, b.registrations);
  EXPECT_EQ(a.loops_in_use, b.loops_in_use);
  EXPECT_EQ(a.wrong_loops_in_use, b.wrong_loops_in_use);
  EXPECT_EQ(a.ate_max_m, b.ate_max_m);
  EXPECT_EQ(a.ate_max_over_path_pct, b.ate_max_over_path_pct);
}

void expect_equal(const MergeRun& a, const MergeRun& b) {
  EXPECT_EQ(a.world, b.world);
  EXPECT_EQ(a.group, b.group);
  EXPECT_EQ(a.keyframes, b.keyframes);
  EXPECT_EQ(a.sensors, b.sensors);
  EXPECT_EQ(a.conditions, b.conditions);
  EXPECT_EQ(a.registrations, b.registrations);
  EXPECT_EQ(a.time_s, b.time_s);
  ASSERT_EQ(a.pairs.size(), b.pairs.size());
  for (std::size_t p = 0; p < a.pairs.size(); ++p) expect_equal(a.pairs[p], b.pairs[p]);
  EXPECT_EQ(a.joint.maps, b.joint.maps);
  EXPECT_EQ(a.joint.possible_maps, b.joint.possible_maps);
  EXPECT_EQ(a.joint.wrong, b.joint.wrong);
  EXPECT_EQ(a.joint.wrong_loops_in_use, b.joint.wrong_loops_in_use);
  EXPECT_EQ(a.joint.ate_max_m, b.joint.ate_max_m);
  EXPECT_EQ(a.joint.ate_max_over_path_pct, b.joint.ate_max_over_path_pct);
}

TEST(MergeResults, ReadBackExactly) {
  const test::TemporaryFolder folder;
  const std::vector<MergeRun> runs = {made_up_run("zab", "all"), made_up_run("mine", "adaptive small")};
  ASSERT_TRUE(write_merge_runs(folder / "results.json", runs));
  const Result<std::vector<MergeRun>> read = read_merge_runs(folder / "results.json");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->size(), 2U);
  for (std::size_t r = 0; r < runs.size(); ++r) expect_equal(read->at(r), runs[r]);
  ASSERT_TRUE(write_merge_runs(folder / "again.json", *read));
  EXPECT_EQ(get_file(folder / "again.json"), get_file(folder / "results.json"));
}

TEST(MergeResults, AMissingFileHoldsNone) {
  const test::TemporaryFolder folder;
  const Result<std::vector<MergeRun>> read = read_merge_runs(folder / "results.json");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(read->empty());
}

TEST(MergeResults, OtherFilesAreRefusedWithTheRemedy) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_merge_runs(folder / "results.json", {made_up_run("zab", "all")}));
  const std::string good = get_file(folder / "results.json");
  const auto replaced = [&](const std::string& what, const std::string& by) {
    std::string text = good;
    EXPECT_NE(text.find(what), std::string::npos) << what;
    return text.replace(text.find(what), what.size(), by);
  };
  for (const std::string& text :
       {std::string(), std::string("{}"), good.substr(0, good.size() / 2), replaced("\"bent\"", "\"so-so\""),
        replaced("\"shared_m\"", "\"shared\""),
        replaced("\"registrations\": 12", "\"registrations\": \"12\""),
        replaced("\"version\": 4", "\"version\": 1"), replaced("\"version\": 4,", "")}) {
    put_file(folder / "results.json", text);
    EXPECT_ERROR(read_merge_runs(folder / "results.json"),
                 "results.json: not results of this version; remove the file");
  }
}

TEST(MergeResults, SpreadsheetsHaveOneLinePerPair) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_merge_csv(folder / "results.csv", {made_up_run("zab", "all"), made_up_run("a", "all")}));
  const Result<std::vector<CsvRow>> rows = parse_csv(get_file(folder / "results.csv"));
  ASSERT_TRUE(rows) << rows.error().message;
  ASSERT_EQ(rows->size(), 9U);
  for (const CsvRow& row : *rows) EXPECT_EQ(row.cells.size(), rows->front().cells.size()) << row.line;
  EXPECT_EQ(rows->front().cells.front(), "world");
  EXPECT_EQ(rows->front().cells.back(), "refused_reason");
  EXPECT_EQ(rows->at(2).cells,
            (std::vector<std::string>{"zab", "check", "all", "os2-32, vlp-16", "field", "ada", "bo", "33.3",
                                      "45.0", "bent", "12", "7", "2", "0.100", "0.200", "0.143", "2.500", "",
                                      "one \"loop\", no more"}));
  EXPECT_EQ(rows->at(5).cells.front(), "a");
}

TEST(PutRun, OtherSensorsAndConditionsStandBesideIt) {
  std::vector<MergeRun> runs = {empty_run("a", "all")};
  MergeRun other = empty_run("a", "all");
  other.conditions = "field";
  put_run(runs, other);
  other.sensors = "vlp-16";
  put_run(runs, other);
  put_run(runs, other);
  EXPECT_EQ(runs.size(), 3U);
  EXPECT_TRUE(is_same_run(runs[2], other));
  for (const std::size_t r : {0U, 1U}) EXPECT_FALSE(is_same_run(runs[r], other)) << r;
}

TEST(PutRun, TakesThePlaceOfTheSameWorldAndPolicy) {
  std::vector<MergeRun> runs;
  for (const auto& [world, keyframes] :
       {std::pair("a", "all"), std::pair("a", "adaptive"), std::pair("b", "all")})
    put_run(runs, empty_run(world, keyframes));
  ASSERT_EQ(runs.size(), 3U);
  put_run(runs, empty_run("a", "adaptive", 5));
  put_run(runs, empty_run("a", "adaptive small", 6));
  ASSERT_EQ(runs.size(), 4U);
  EXPECT_EQ(runs[0].registrations, 0);
  EXPECT_EQ(runs[1].registrations, 5);
  EXPECT_EQ(runs[2].registrations, 0);
  EXPECT_EQ(runs[3].registrations, 6);
}

/// Two robots that drove one street towards one another, nearly without drift.
std::vector<RobotRun> street_runs() {
  const test::BoxWorld world(3);
  const std::vector<std::vector<Pose>> truths = {test::street(0.0, 40.0, -0.5),
                                                 test::street(50.0, 14.0, 0.5)};
  std::vector<RobotRun> runs;
  for (std::size_t r = 0; r < truths.size(); ++r) {
    RobotRun run;
    run.map = run.paper_map =
        std::make_shared<const RobotMap>(test::drive(world, {static_cast<std::uint8_t>(r)}, truths[r], 1e-4));
    for (std::size_t k = 0; k < truths[r].size(); ++k)
      run.truth.push_back({run.map->keyframes[k].stamp, truths[r][k]});
    run.result.name = run.map->name;
    run.result.path_length_m = path_length(run.truth);
    runs.push_back(std::move(run));
  }
  return runs;
}

SlamConfig street_config() {
  SlamConfig config;
  config.keyframes = KeyframeSelection::all;
  config.loops = test::lenient();
  return config;
}

const DistinctiveMetres kOneStretch = {{0.0, 20.0}, {20.0, 0.0}};

TEST(MergeTruth, IsTheSharedStretchAndTheDriftOfEach) {
  std::vector<RobotRun> runs = street_runs();
  const Result<MergeTruth> truth = merge_truth(runs, KeyframeSelection::all, kOneStretch);
  ASSERT_TRUE(truth) << truth.error().message;
  EXPECT_EQ(truth->shared_m[0][0], 0.0) << "nobody merges with itself";
  EXPECT_EQ(truth->shared_m[0][1], truth->shared_m[1][0]);
  EXPECT_NEAR(truth->shared_m[0][1], 26.0, 4.0);  // from x = 14 to 40, and within reach of the ends
  EXPECT_EQ(truth->distinctive_m, kOneStretch);
  for (const double drift : truth->drift_m) {
    EXPECT_GT(drift, 0.001);
    EXPECT_LT(drift, 0.2);
  }
  for (StampedPose& pose : runs[1].truth) pose.stamp.ns += 1'000'000'000'000;
  EXPECT_ERROR(merge_truth(runs, KeyframeSelection::all, kOneStretch), "robot_1: ");
}

/// What `runs` come to with `config`, judged by their truth.
MergeRun merges_of(const std::vector<RobotRun>& runs, const DistinctiveMetres& distinctive,
                   const SlamConfig& config) {
  const Result<MergeTruth> truth = merge_truth(runs, config.keyframes, distinctive);
  EXPECT_TRUE(truth) << truth.error().message;
  const Result<MergeRun> run = run_merges(runs, *truth, config);
  EXPECT_TRUE(run) << run.error().message;
  return run.value_or(MergeRun{});
}

TEST(RunMerges, TheTruthAloneDecidesWhetherAMergeIsRight) {
  std::vector<RobotRun> runs = street_runs();
  const MergeRun right = merges_of(runs, kOneStretch, street_config());
  ASSERT_EQ(right.pairs.size(), 1U);
  const MergePair& pair = right.pairs[0];
  EXPECT_EQ(pair.robots, (std::array<std::string, 2>{"robot_0", "robot_1"}));
  EXPECT_EQ(pair.outcome, MergeOutcome::success) << pair.refused_reason;
  EXPECT_TRUE(pair.mergeable());
  EXPECT_GT(pair.loops_in_use, 0);
  // A few join keyframes that are more than 10 m apart, which counts as a wrong place however exact they are.
  EXPECT_LT(2 * pair.wrong_loops_in_use, pair.loops_in_use);
  EXPECT_LT(pair.ate_max_m[0], 0.4);
  EXPECT_EQ(right.keyframes, "all");
  EXPECT_EQ(right.registrations, pair.registrations) << "there are no other robots";
  EXPECT_EQ(right.joint.maps, (std::vector<std::vector<std::string>>{{"robot_0", "robot_1"}}));
  EXPECT_EQ(right.joint.possible_maps, right.joint.maps);
  EXPECT_FALSE(right.joint.wrong);

  // The same scans, but the second robot was in truth in another street that looks the same.
  for (StampedPose& pose : runs[1].truth)
    pose.T_world_body = Pose::translation_of(0, 200, 0) * pose.T_world_body;
  const MergeRun wrong = merges_of(runs, {{0, 0}, {0, 0}}, street_config());
  EXPECT_EQ(wrong.pairs[0].outcome, MergeOutcome::wrong);
  EXPECT_EQ(wrong.pairs[0].loops_in_use, pair.loops_in_use) << "what decides does not see the truth";
  EXPECT_EQ(wrong.pairs[0].wrong_loops_in_use, pair.loops_in_use);
  EXPECT_FALSE(wrong.pairs[0].mergeable());
  EXPECT_GT(wrong.pairs[0].ate_max_m[0], 20.0);
  EXPECT_TRUE(wrong.joint.wrong);
  EXPECT_EQ(wrong.joint.maps, right.joint.maps);
  EXPECT_EQ(wrong.joint.possible_maps, (std::vector<std::vector<std::string>>{{"robot_0"}, {"robot_1"}}));
}

TEST(RunMerges, ARefusedPairHasAReasonAndNothingWrong) {
  SlamConfig config = street_config();
  config.loops.registration.min_inliers = 100000;
  const MergeRun run = merges_of(street_runs(), {{0, 0}, {0, 0}}, config);
  ASSERT_EQ(run.pairs.size(), 1U);
  EXPECT_EQ(run.pairs[0].outcome, MergeOutcome::refused);
  EXPECT_NE(run.pairs[0].refused_reason, "");
  EXPECT_GT(run.pairs[0].registrations, 0);
  EXPECT_EQ(run.pairs[0].loops_in_use, 0);
  EXPECT_EQ(run.joint.maps, (std::vector<std::vector<std::string>>{{"robot_0"}, {"robot_1"}}));
  EXPECT_EQ(run.joint.possible_maps, run.joint.maps) << "they share metres, but no distinctive stretch";
  EXPECT_FALSE(run.joint.wrong);
}

}  // namespace
}  // namespace adit

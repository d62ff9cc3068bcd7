// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/study.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "adit/io/tum.hpp"
#include "adit/io/world_files.hpp"
#include "support/files.hpp"
#include "support/made_up_study.hpp"
#include "support/short_drives.hpp"

namespace adit {
namespace {

using test::get_file;

World short_world(const test::TemporaryFolder& folder, const std::vector<std::string>& names) {
  const ListedWorld listed = test::put_short_drives(folder.path(), names);
  const Result<World> world = load_world({}, listed.routes_file);
  EXPECT_TRUE(world) << world.error().message;
  return world.value_or(World{});
}

std::vector<std::string> methods_of(const RobotResult& robot) {
  std::vector<std::string> methods;
  for (const OdometryResult& odometry : robot.odometry) methods.push_back(odometry.method);
  return methods;
}

TEST(RunRobots, EachIsDrivenByEveryOdometryThatIsCompared) {
  const test::TemporaryFolder folder;
  const World world = short_world(folder, {"ahead", "behind"});
  RunConfig config = test::quick_config();
  const Result<std::vector<Recording>> recordings = simulate(world, config.simulation);
  ASSERT_TRUE(recordings) << recordings.error().message;
  const Result<std::vector<RobotRun>> runs = run_robots(*recordings, config);
  ASSERT_TRUE(runs) << runs.error().message;
  ASSERT_EQ(runs->size(), 2U);
  for (std::size_t r = 0; r < 2; ++r) {
    const RobotRun& run = runs->at(r);
    EXPECT_EQ(run.result.name, recordings->at(r).name);
    EXPECT_EQ(run.map->id.value, r);
    EXPECT_EQ(methods_of(run.result), (std::vector<std::string>{"kiss_icp", "kinematic_icp", "plane_icp"}));
    EXPECT_EQ(run.result.scans, static_cast<int>(recordings->at(r).num_scans()));
    ASSERT_TRUE(run.result.odometry[2].ate.has_value());
    EXPECT_LT(run.result.odometry[2].ate->max_m, 0.3);
    EXPECT_EQ(run.map_for(KeyframeSelection::adaptive), run.map);
    EXPECT_EQ(run.map_for(KeyframeSelection::all), run.paper_map);
  }
  // Where both are KISS-ICP there is one map, and no comparison beside it.
  config.slam.robot.odometry.method = config.paper_odometry = OdometryMethod::kiss_icp;
  const Result<std::vector<RobotRun>> kiss = run_robots(*recordings, config);
  ASSERT_TRUE(kiss) << kiss.error().message;
  EXPECT_EQ(kiss->at(0).map, kiss->at(0).paper_map);
  EXPECT_EQ(methods_of(kiss->at(0).result), std::vector<std::string>{"kiss_icp"});
  EXPECT_EQ(tum_text(kiss->at(1).truth), tum_text(recordings->at(1).truth));
}

TEST(RunRobots, ARecordingThatCannotBeReadStopsTheStudy) {
  Recording recording;
  recording.name = "alpha";
  for (int k = 0; k < 3; ++k) recording.scan_stamps.push_back(Stamp{1'000'000'000LL * (k + 1)});
  recording.read_scan = [](std::size_t) -> Result<Scan> { return fail("alpha.bag: torn"); };
  EXPECT_ERROR(run_robots({recording}, test::quick_config()), "alpha.bag: torn");
}

TEST(RunStudy, HasEveryPairUnderEveryPolicyAndLeavesItsSessions) {
  const test::TemporaryFolder folder;
  const World world = short_world(folder, {"ahead", "behind", "last"});
  Study study{.config = test::quick_config(),
              .policies = {KeyframeSelection::all, KeyframeSelection::tunnel_filter_keep},
              .provenance = {},
              .folder = folder / "out"};
  study.config.slam.robot.odometry.method = study.config.paper_odometry;
  std::filesystem::create_directories(study.folder);
  const Result<StudyResult> result = run_study(study, world);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->world, "hall");
  EXPECT_EQ(result->lidar, study.config.simulation.lidar.name);
  std::vector<std::string> pairs;
  for (const PairResult& pair : result->pairs)
    pairs.push_back(pair.robots[0].name + "-" + pair.robots[1].name + " " + pair.keyframes +
                    (pair.pcm ? " pcm" : ""));
  EXPECT_EQ(pairs, (std::vector<std::string>{
                       "ahead-behind all", "ahead-behind all pcm", "ahead-behind tunnel_filter_keep",
                       "ahead-behind tunnel_filter_keep pcm", "ahead-last all", "ahead-last all pcm",
                       "ahead-last tunnel_filter_keep", "ahead-last tunnel_filter_keep pcm",
                       "behind-last all", "behind-last all pcm", "behind-last tunnel_filter_keep",
                       "behind-last tunnel_filter_keep pcm"}));
  ASSERT_TRUE(result->joint.has_value());
  EXPECT_EQ(result->joint->keyframes, "tunnel_filter_keep") << "the last policy";
  EXPECT_EQ(result->joint->maps.size(), 3U);
  for (const RobotResult& robot : result->robots) {
    const Result<Trajectory> truth = read_tum(study.folder / "robots" / robot.name / "truth.tum");
    ASSERT_TRUE(truth) << truth.error().message;
    EXPECT_NEAR(path_length(*truth), test::kShortDriveMetres, 0.5);
  }
  for (const char* pair : {"ahead-behind", "ahead-last", "behind-last"})
    for (const char* policy : {"all", "tunnel_filter_keep"}) {
      const Result<SavedSession> session = read_session(study.folder / "pairs" / pair / policy);
      ASSERT_TRUE(session) << session.error().message;
      EXPECT_EQ(session->robots.size(), 2U);
    }
  const Result<SavedSession> joint = read_session(study.folder / "joint");
  ASSERT_TRUE(joint) << joint.error().message;
  EXPECT_EQ(joint->robots, (std::vector<std::string>{"ahead", "behind", "last"}));
}

TEST(StudyReport, HoldsTablesFiguresAndNumbers) {
  const test::TemporaryFolder folder;
  const StudyResult result = made_up::study();
  const std::vector<Table> tables = tables_of(result);
  const Result<> written = write_study_report(result, tables, folder.path());
  ASSERT_TRUE(written) << written.error().message;
  const std::string page = get_file(folder / "tables.md");
  for (const Table& table : tables)
    EXPECT_NE(page.find("**" + table.title), std::string::npos) << table.title;
  EXPECT_EQ(nlohmann::json::parse(get_file(folder / "metrics.json"))["world"], result.world);
  EXPECT_NE(get_file(folder / "report.html").find("<svg"), std::string::npos);
  std::size_t num_svg = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "figures")) {
    if (entry.path().extension() != ".svg") continue;
    ++num_svg;
    std::filesystem::path png = entry.path();
    EXPECT_TRUE(get_file(png.replace_extension(".png")).starts_with("\x89PNG")) << png;
  }
  EXPECT_GT(num_svg, 2U);
  EXPECT_EQ(test::num_entries(folder / "figures"), 2 * num_svg);
}

TEST(StudyTables, ThePapersFiguresStandBesideAStudyOfItsKindAlone) {
  StudyResult result = made_up::study();
  result.world = "zab";
  const auto columns = [&] { return tables_of(result).front().header.size(); };
  const std::size_t with_two_robots = columns();
  result.robots.resize(4, result.robots.front());
  EXPECT_GT(columns(), with_two_robots);
  result.world = "mine";
  EXPECT_EQ(columns(), with_two_robots);
}

}  // namespace
}  // namespace adit

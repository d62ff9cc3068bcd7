// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Two simulated robots on a stretch of tunnel that they share: from scans to one map.
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include "adit/core/parallel.hpp"
#include "adit/evaluation/ate.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/io/g2o.hpp"
#include "adit/io/scan_folder.hpp"
#include "adit/io/tum.hpp"
#include "examples/simulated.hpp"
#include "support/files.hpp"
#include "support/meeting.hpp"

namespace adit {
namespace {

std::vector<Recording> two_robots() {
  Result<std::vector<Recording>> robots = example::two_robots_of_zab();
  EXPECT_TRUE(robots.has_value()) << robots.error().message;
  return robots.value_or(std::vector<Recording>{});
}

/// The joint map as the files that `adit slam` would write.
std::string as_text(const test::Joint& joint, const std::filesystem::path& folder) {
  std::string text;
  for (const Trajectory& trajectory : test::joint_trajectories(joint)) {
    EXPECT_TRUE(write_tum(folder / "trajectory.tum", trajectory).has_value());
    text += test::get_file(folder / "trajectory.tum");
  }
  std::ostringstream graph;
  write_g2o(graph, joint.solution.optimized);
  return text + graph.str();
}

TEST(EndToEnd, UnderThePapersPolicyTwoRobotsMergeByCorrectLoopsIntoAnAccurateMap) {
  const std::vector<Recording> recordings = two_robots();
  ASSERT_EQ(recordings.size(), 2U);
  const test::Joint joint = test::map_and_meet(recordings, RobotSlamConfig(), test::paper());
  ASSERT_EQ(joint.solution.components.size(), 1U) << joint.solution.pairs.at(0).refused_reason;
  const LoopCounts loops = test::loops_in_use(joint, recordings);
  EXPECT_GE(loops.total, 5);
  EXPECT_EQ(loops.wrong(), 0);

  const std::vector<Trajectory> estimates = test::joint_trajectories(joint);
  const auto errors = joint_ate(estimates, std::vector{recordings[0].truth, recordings[1].truth});
  ASSERT_TRUE(errors.has_value()) << errors.error().message;
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_GT(path_length(estimates[i]), 50.0);
    // Odometry is now stated to be ten times as good as the loops, which are all taken for 0.1 m and 0.6
    // degrees: these leave the frame between the robots to half a per cent.
    EXPECT_LT((*errors)[i].max_m, 0.005 * path_length(estimates[i])) << recordings[i].name;
  }

  // The same bytes with another number of threads.
  const test::TemporaryFolder folder;
  const int threads_before = num_threads();
  set_num_threads(threads_before == 1 ? 2 : 1);
  const test::Joint again = test::map_and_meet(recordings, RobotSlamConfig(), test::paper());
  set_num_threads(threads_before);
  EXPECT_EQ(as_text(joint, folder.path()), as_text(again, folder.path()));
}

TEST(EndToEnd, ByDefaultRobotsMergeByEvidenceAndSaySo) {
  const std::vector<Recording> recordings = two_robots();
  ASSERT_EQ(recordings.size(), 2U);
  const test::Joint joint = test::map_and_meet(recordings, RobotSlamConfig());
  ASSERT_EQ(joint.solution.components.size(), 1U) << joint.solution.pairs.at(0).refused_reason;
  EXPECT_EQ(test::loops_in_use(joint, recordings).wrong(), 0);
  const MergeCheck& check = joint.fleet.checks.begin()->second;
  EXPECT_TRUE(check.accepted);
  EXPECT_GE(check.evidence, check.needed);
  const std::vector<Trajectory> estimates = test::joint_trajectories(joint);
  const auto errors = joint_ate(estimates, std::vector{recordings[0].truth, recordings[1].truth});
  ASSERT_TRUE(errors.has_value()) << errors.error().message;
  for (std::size_t i = 0; i < 2; ++i)
    // Odometry is now stated to be ten times as good as the loops, which are all taken for 0.1 m and 0.6
    // degrees: these leave the frame between the robots to half a per cent.
    EXPECT_LT((*errors)[i].max_m, 0.005 * path_length(estimates[i])) << recordings[i].name;
}

std::size_t num_lines_with(const std::string& text, const std::string& start) {
  std::istringstream lines(text);
  std::size_t count = 0;
  for (std::string line; std::getline(lines, line);) count += line.starts_with(start) ? 1 : 0;
  return count;
}

TEST(EndToEnd, TheProgramMapsAFolderOfScansIntoASession) {
  constexpr std::size_t kNumScans = 12;
  const test::TemporaryFolder folder;
  std::vector<Recording> recordings = two_robots();
  ASSERT_EQ(recordings.size(), 2U);
  std::ostringstream command;
  command << ADIT_PROGRAM << " slam";
  for (Recording& recording : recordings) {
    const Recording few = example::part_of(recording, 0, kNumScans);
    const std::filesystem::path scans = folder / recording.name;
    ASSERT_TRUE(write_scan_folder(scans, few).has_value());
    command << ' ' << scans.string();
  }
  command << " --out " << (folder / "session").string() << " > " << (folder / "log").string() << " 2>&1";
  ASSERT_EQ(std::system(command.str().c_str()), 0) << test::get_file(folder / "log");
  // What the files say agrees with the truth and with one another.
  std::size_t num_keyframes = 0;
  for (const Recording& recording : recordings) {
    const std::filesystem::path robot = folder / "session" / recording.name;
    const Result<Trajectory> odometry = read_tum(robot / "odometry.tum");
    const Result<Trajectory> optimized = read_tum(robot / "trajectory.tum");
    ASSERT_TRUE(odometry) << odometry.error().message;
    ASSERT_TRUE(optimized) << optimized.error().message;
    EXPECT_EQ(odometry->size(), kNumScans) << recording.name;
    EXPECT_GE(optimized->size(), 5U) << recording.name;
    EXPECT_GT(path_length(*optimized), 3.0) << recording.name;
    const Result<AteResult> error = ate(*optimized, recording.truth);
    ASSERT_TRUE(error) << error.error().message;
    EXPECT_LT(error->max_m, 0.08) << recording.name;  // the noise of one range of this sensor, at its worst
    num_keyframes += optimized->size();
  }
  for (const char* name : {"graph_initial.g2o", "graph_pcm.g2o", "graph_optimized.g2o"}) {
    const std::string graph = test::get_file(folder / "session" / name);
    EXPECT_EQ(num_lines_with(graph, "VERTEX_SE3:QUAT"), num_keyframes) << name;
    EXPECT_GE(num_lines_with(graph, "EDGE_SE3:QUAT"), num_keyframes - recordings.size()) << name;
  }
  const Result<PointCloud> map = read_cloud(folder / "session/map.ply");
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_GT(map->size(), 1000U);
  EXPECT_TRUE(test::get_file(folder / "session/loops.csv").starts_with("from_robot,from_keyframe,"));
  EXPECT_NE(test::get_file(folder / "session/session.toml").find("adit slam"), std::string::npos);
  for (const Recording& recording : recordings)
    EXPECT_NE(test::get_file(folder / "session/report.html").find(recording.name), std::string::npos);
}

}  // namespace
}  // namespace adit

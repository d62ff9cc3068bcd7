// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Sessions that grow: robots added later, sessions joined, a robot found in a saved map, and a person's word.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "adit/core/format.hpp"
#include "adit/evaluation/ate.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/robot_map_file.hpp"
#include "adit/io/session_dir.hpp"
#include "adit/io/tum.hpp"
#include "adit/slam/saved_fleet.hpp"
#include "adit/slam/slam.hpp"
#include "support/files.hpp"
#include "support/program.hpp"
#include "support/two_drives.hpp"

namespace adit {
namespace {

namespace fs = std::filesystem;
using test::expect_done;
using test::expect_refused;
using test::get_file;
using test::put_file;
using test::run_adit;

/// Recordings of one mine: `ahead`, `behind` and `later` drive along one tunnel, `far` along another.
class Growing : public ::testing::Test {
 protected:
  void SetUp() override {
    test::put_drives(folder_.path(),
                     {{0, 50, "ahead"}, {10, 60, "behind"}, {5, 55, "later"}, {130, 170, "far"}});
    expect_done("simulate --routes " + in("routes.yaml") + " --lidar os2-32 --out " + in("drives"));
  }

  [[nodiscard]] std::string in(const std::string& name) const { return (folder_ / name).string(); }
  [[nodiscard]] std::string drive(const std::string& robot) const { return in("drives/" + robot + ".mcap"); }
  [[nodiscard]] std::string text_of(const std::string& name) const { return get_file(folder_ / name); }

  /// All that was measured and decided: what is left out says which commands it took.
  void expect_same_results(const std::string& a, const std::string& b,
                           const std::vector<std::string>& robots) const {
    std::vector<std::string> files = {"map.ply",   "graph_initial.g2o",   "graph_pcm.g2o",
                                      "loops.csv", "graph_optimized.g2o", "fleet.adit"};
    for (const std::string& robot : robots)
      for (const char* file : {"/map.adit", "/map.ply", "/trajectory.tum", "/odometry.tum"})
        files.push_back(robot + file);
    for (const std::string& file : files)
      EXPECT_TRUE(text_of(a + "/" + file) == text_of(b + "/" + file)) << file << " differs";
    EXPECT_EQ(read_session(in(a))->components, read_session(in(b))->components);
  }

  const test::TemporaryFolder folder_;
};

TEST_F(Growing, InStepsGivesWhatAllAtOnceGives) {
  const std::string three = drive("ahead") + " " + drive("behind") + " " + drive("later");
  expect_done("slam " + three + " --out " + in("at_once"));
  expect_done("slam " + drive("ahead") + " " + drive("behind") + " --out " + in("grown"));
  // As if an earlier version had saved it.
  put_file(folder_ / "grown/session.toml",
           text_of("grown/session.toml") + "\n[configuration.gone]\nsetting = 1.0\n");
  const test::ProgramRun growth = run_adit("slam --session " + in("grown") + " " + drive("later"));
  EXPECT_EQ(growth.exit_code, 0) << growth.err;
  EXPECT_NE(growth.err.find("unknown configuration key 'gone.setting'"), std::string::npos) << growth.err;
  expect_same_results("at_once", "grown", {"ahead", "behind", "later"});
  const SavedSession grown = read_session(in("grown")).value();
  EXPECT_EQ(grown.components.size(), 1U);
  EXPECT_EQ(grown.provenance.inputs, read_session(in("at_once"))->provenance.inputs);
  ASSERT_EQ(grown.provenance.earlier_commands.size(), 1U);
  EXPECT_EQ(grown.provenance.earlier_commands.front(), "adit slam " + drive("ahead") + " " + drive("behind"));
  EXPECT_EQ(grown.provenance.robots.size(), 3U);
  const std::string rerun = "slam --rerun " + in("grown") + "/session.toml --out " + in("again");
  expect_refused(rerun, 1,
                 "adit slam " + drive("ahead") + " " + drive("behind") + " --out DIR; adit slam " +
                     drive("later") + " --session " + in("grown") + "\n");
  put_file(folder_ / "grown/georeference.toml", "");
  expect_refused(rerun, 1, "its georeference is not among them");

  // Two teams, who both called a robot alike.
  expect_done("slam robot=" + drive("ahead") + " --out " + in("a"));
  expect_done("slam robot=" + drive("behind") + " later=" + drive("later") + " --out " + in("b"));
  const test::ProgramRun run = run_adit("merge " + in("a") + " " + in("b") + " --out " + in("joined"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("the robot 'robot' is called robot_2 here"), std::string::npos) << run.err;
  for (const auto& [joined, at_once] :
       {std::pair{"robot", "ahead"}, std::pair{"robot_2", "behind"}, std::pair{"later", "later"}})
    EXPECT_TRUE(text_of(std::string("joined/") + joined + "/trajectory.tum") ==
                text_of(std::string("at_once/") + at_once + "/trajectory.tum"))
        << joined;
  expect_refused("merge " + in("a") + " " + in("b") + " --set bus.loss=0.1 --out " + in("c"), 2,
                 "it began with");

  // Two teams, who both hold one of the robots.
  const test::ProgramRun shared = run_adit("merge " + in("a") + " " + in("at_once") + " --out " + in("d"));
  EXPECT_EQ(shared.exit_code, 0) << shared.err;
  EXPECT_EQ(shared.err,
            "adit merge: note: ahead of " + in("at_once") + " and robot of " + in("a") +
                " have the same map, to the bit: it is one recording, which counts once; what was "
                "found or ruled about the former is left out, and its pairs are tested anew\n");
  EXPECT_EQ(read_session(in("d"))->robots, (std::vector<std::string>{"robot", "behind", "later"}));
  EXPECT_EQ(read_session(in("d"))->components.size(), 1U);
}

void expect_a_pose_each_scan(const Trajectory& poses, const std::string& drive) {
  const Result<Recording> recording = open_recording(drive);
  ASSERT_TRUE(recording) << recording.error().message;
  ASSERT_EQ(poses.size(), recording->num_scans());
  for (std::size_t i = 0; i < poses.size(); ++i) EXPECT_EQ(poses[i].stamp, recording->scan_stamps[i]);
}

/// Each of the one, with its stamp, is one of the other.
void expect_poses_among(const Trajectory& few, const Trajectory& many) {
  EXPECT_LT(few.size(), many.size());
  for (const StampedPose& pose : few) {
    const auto same = std::ranges::find(many, pose.stamp, &StampedPose::stamp);
    ASSERT_NE(same, many.end()) << stamp_text(pose.stamp);
    EXPECT_LT((pose.T_world_body.inverse() * same->T_world_body).log().norm(), 1e-9)
        << stamp_text(pose.stamp);
  }
}

TEST_F(Growing, ARobotIsFoundInASavedMapOrItIsSaidWhyNot) {
  expect_done("slam " + drive("ahead") + " --out " + in("map"));
  const std::string before = text_of("map/session.toml");
  const test::ProgramRun run =
      run_adit("--json localize " + in("map") + " " + drive("later") + " --out " + in("later.tum"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json found = nlohmann::json::parse(run.out);
  EXPECT_EQ(found["frame_of"], "ahead");
  EXPECT_EQ(found["found_by"], nlohmann::json::array({"ahead"}));
  EXPECT_EQ(found["written"], nlohmann::json::array({in("later.tum"), in("later_scans.tum")}));
  const Trajectory at_keyframes = read_tum(folder_ / "later.tum").value();
  const Trajectory at_scans = read_tum(folder_ / "later_scans.tum").value();
  expect_a_pose_each_scan(at_scans, drive("later"));
  expect_poses_among(at_keyframes, at_scans);
  EXPECT_EQ(found["keyframes"], at_keyframes.size());
  EXPECT_EQ(found["scans"], at_scans.size());
  // In the frame of the map: one alignment serves both robots.
  const Trajectory of_map = read_tum(folder_ / "map/ahead/trajectory.tum").value();
  const std::vector<Trajectory> truths = {read_tum(folder_ / "drives/ahead_truth.tum").value(),
                                          read_tum(folder_ / "drives/later_truth.tum").value()};
  for (const Trajectory& poses : {at_keyframes, at_scans}) {
    const Result<std::vector<AteResult>> errors = joint_ate(std::vector{of_map, poses}, truths);
    ASSERT_TRUE(errors) << errors.error().message;
    for (const AteResult& error : *errors) EXPECT_LT(error.max_m, 0.3);
  }
  expect_refused("localize " + in("map") + " " + drive("far") + " --out " + in("far.tum"), 1,
                 "far was not found");
  for (const char* file : {"far.tum", "far_scans.tum"}) EXPECT_FALSE(fs::exists(folder_ / file)) << file;
  expect_refused("localize " + in("map") + " " + drive("ahead"), 1,
                 "is the recording of ahead in " + in("map") + "; where that robot was says " +
                     in("map/ahead/trajectory.tum"));
  EXPECT_EQ(text_of("map/session.toml"), before);
}

TEST_F(Growing, APersonOverrulesTheTest) {
  expect_done("slam " + drive("ahead") + " " + drive("behind") + " --out " + in("s"));
  expect_done("slam --session " + in("s") + " --veto behind,ahead --out " + in("vetoed"));
  EXPECT_EQ(read_session(in("vetoed"))->components.size(), 2U);
  EXPECT_NE(text_of("vetoed/session.toml").find("a person keeps these maps apart"), std::string::npos);
  const test::ProgramRun explained = run_adit("explain " + in("vetoed") + " ahead behind");
  EXPECT_NE(explained.out.find("ahead and behind: not merged (vetoed)"), std::string::npos) << explained.out;
  EXPECT_EQ(explained.out.find("unsure"), std::string::npos) << explained.out;
  for (const char* file : {"vetoed/session.toml", "vetoed/metrics.json", "vetoed/report.html"})
    EXPECT_NE(text_of(file).find("vetoed"), std::string::npos) << file;
  // It holds for what comes later, until it is taken back.
  expect_done("slam --session " + in("vetoed") + " " + drive("far"));
  EXPECT_EQ(read_session(in("vetoed"))->components.size(), 3U);
  expect_done("slam --session " + in("vetoed") + " --confirm ahead,behind");
  EXPECT_EQ(read_session(in("vetoed"))->components.size(), 2U);
  EXPECT_NE(text_of("vetoed/session.toml").find("a person confirmed this merge; the test had said: "),
            std::string::npos);
  EXPECT_EQ(text_of("vetoed/session.toml").find("keeps these maps apart"), std::string::npos)
      << "taken back, and not quoted";
  EXPECT_TRUE(text_of("vetoed/ahead/trajectory.tum") == text_of("s/ahead/trajectory.tum"));
  // Withdrawn, the test's own verdict counts again.
  expect_done("slam --session " + in("vetoed") + " --withdraw behind,ahead");
  EXPECT_EQ(read_session(in("vetoed"))->components.size(), 2U);
  EXPECT_EQ(text_of("vetoed/session.toml").find("a person"), std::string::npos);
  expect_refused("slam --session " + in("vetoed") + " --withdraw ahead,behind", 1, "nobody has ruled");
  expect_refused("slam --session " + in("vetoed") + " --withdraw ahead:1,behind:2", 2, "write A,B");

  expect_refused("slam --session " + in("vetoed") + " --confirm far,behind", 1, "no alignment was found");
  expect_refused("slam --session " + in("s") + " --veto ahead,nobody", 1,
                 "no robot is called nobody; there are: ahead behind");
  expect_refused("slam --session " + in("s") + " --veto ahead", 2, "names no two robots");
  expect_refused("slam " + drive("ahead") + " --veto ahead,far --out " + in("x"), 2,
                 "give it with --session");
  expect_refused("slam --session " + in("s"), 2, "give recordings to add");
}

/// The latest check of two robots among findings.
MergeCheck* check_between_robots(std::vector<MessageBody>& findings) {
  MergeCheck* latest = nullptr;
  for (MessageBody& finding : findings)
    if (auto* checks = std::get_if<MergeChecks>(&finding))
      for (MergeCheck& check : checks->checks)
        if (check.a != check.b) latest = &check;
  return latest;
}

TEST_F(Growing, APersonConfirmsAnotherAlignmentThanTheBest) {
  expect_done("slam " + drive("ahead") + " " + drive("behind") + " --out " + in("s"));
  SavedFleet saved = read_fleet(in("s")).value();
  MergeCheck* check = check_between_robots(saved.findings);
  ASSERT_NE(check, nullptr);
  ASSERT_GE(check->loops.size(), 2U);
  // As if the last loop had been of a hypothesis of its own.
  MergeHypothesis other = check->hypotheses.front();
  other.outcome = HypothesisOutcome::behind;
  other.evidence = 1.5;
  other.loops = {check->loops.back()};
  check->loops.pop_back();
  check->hypotheses.front().loops = check->loops;
  check->hypotheses.insert(check->hypotheses.begin() + 1, other);
  const Ruling ruling{Ruling::Kind::confirm, "ahead", "behind",
                      Ruling::Loop{other.loops[0].first, other.loops[0].second}};
  Result<SlamRun> run = slam_on({saved}, {}, {}, {ruling});
  ASSERT_TRUE(run) << run.error().message;
  const MergeCheck* ruled = check_between_robots(run->findings);
  ASSERT_NE(ruled, nullptr);
  EXPECT_TRUE(ruled->accepted);
  EXPECT_EQ(ruled->loops, other.loops);
  EXPECT_EQ(ruled->evidence, 1.5);
  EXPECT_EQ(ruled->hypotheses[0].outcome, HypothesisOutcome::accepted);
  EXPECT_EQ(ruled->hypotheses[1].outcome, HypothesisOutcome::behind) << "the one that was the best";
  EXPECT_NE(ruled->reason.find("by the loop of "), std::string::npos) << ruled->reason;
}

/// The keyframes of the first loop that joins two robots in that session, as options name them.
std::string first_loop_of(const SavedSession& session) {
  for (const SavedLoop& loop : session.loops)
    if (loop.in_use() && loop.from_robot != loop.to_robot)
      return format("{}:{},{}:{}", loop.from_robot, loop.loop.from.index, loop.to_robot, loop.loop.to.index);
  ADD_FAILURE() << "no loop joins two robots";
  return "";
}

TEST_F(Growing, APersonLeavesOutALoop) {
  expect_done("slam " + drive("ahead") + " " + drive("behind") + " --out " + in("s"));
  const auto num_in_use = [&](const std::string& session) {
    const Result<SavedSession> saved = read_session(in(session));
    return std::ranges::count_if(saved->loops, &SavedLoop::in_use);
  };
  const std::string loop = first_loop_of(*read_session(in("s")));
  expect_done("slam --session " + in("s") + " --veto " + loop + " --out " + in("fewer"));
  EXPECT_EQ(num_in_use("fewer"), num_in_use("s") - 1);
  EXPECT_NE(text_of("fewer/session.toml").find("a person left out the loop of "), std::string::npos);
  expect_refused("slam --session " + in("fewer") + " --veto " + loop, 1, "loops.csv lists those in use");
  expect_done("slam --session " + in("fewer") + " --confirm " + loop + " --out " + in("again"));
  EXPECT_EQ(num_in_use("again"), num_in_use("s"));
  EXPECT_NE(text_of("again/session.toml").find("a person confirmed this merge by the loop of "),
            std::string::npos);
  expect_refused("slam --session " + in("s") + " --confirm ahead:0,behind:99999", 1,
                 "belongs to no alignment");
  expect_refused("slam --session " + in("s") + " --veto ahead:0,behind", 2, "a keyframe of both robots");
  expect_refused("slam --session " + in("s") + " --veto ahead:x,behind:1", 2, "the number of a keyframe");
}

TEST_F(Growing, ASessionOfOthersIsNotReplaced) {
  expect_done("slam " + drive("far") + " --out " + in("s"));
  const std::string toml = text_of("s/session.toml");
  expect_refused("slam " + drive("later") + " --out " + in("s"), 1,
                 "holds a session with the map of far, which this run would replace");
  expect_done("slam " + drive("later") + " --out " + in("other"));
  expect_refused("slam --session " + in("other") + " " + drive("ahead") + " --out " + in("s"), 1,
                 "adit slam --session " + in("s"));
  expect_refused("merge " + in("other") + " " + in("other") + " --out " + in("s"), 1, "the map of far");
  EXPECT_EQ(text_of("s/session.toml"), toml);
  expect_done("slam " + drive("far") + " --out " + in("s"));
  expect_done("slam --rerun " + in("s") + "/session.toml --out " + in("s"));

  // Two robots that share nothing have a map each.
  expect_done("slam --session " + in("s") + " " + drive("later"));
  const test::ProgramRun larger = run_adit("convert " + in("s") + " " + in("map.pgm"));
  EXPECT_NE(larger.err.find("later is in another map and left out; --robot later writes that one"),
            std::string::npos)
      << larger.err;
  EXPECT_EQ(larger.out, "written: " + in("map.pgm") + ", " + in("map.yaml") + "\n");
  const test::ProgramRun other = run_adit("convert " + in("s") + " " + in("later.pgm") + " --robot later");
  EXPECT_NE(other.err.find("far is in another map and left out"), std::string::npos) << other.err;
  EXPECT_NE(text_of("later.pgm"), text_of("map.pgm"));
  expect_refused("convert " + in("s") + " " + in("x.pgm") + " --robot hans", 1, "there are: far, later");
  EXPECT_EQ(run_adit("convert " + in("s") + " " + in("at.tum")).out,
            "written: " + in("at_far.tum") + ", " + in("at_later.tum") + "\n");
  const test::ProgramRun found = run_adit("info " + in("s/fleet.adit"));
  EXPECT_NE(found.out.find("next: adit info " + in("s")), std::string::npos) << found.out << found.err;
}

TEST_F(Growing, NewRecordingsAreReadAsTheCommandSays) {
  const std::string grow = "slam --session " + in("s") + " " + drive("later") + " --out " + in("grown");
  expect_done("slam " + drive("far") + " --mount 0.5,0,1.5 --out " + in("s"));
  const test::ProgramRun run = run_adit(grow + " --set recording.wheel=none --set recording.imu=none");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("later: no wheel odometry"), std::string::npos) << run.err;
  const Vector3 told(0.5, 0.0, 1.5);
  EXPECT_EQ(read_robot_map(in("grown/far/map.adit"))->viewpoint, told);
  EXPECT_NE(read_robot_map(in("grown/later/map.adit"))->viewpoint, told);
  expect_refused(grow + " --set loops.place.max_distance=0.1", 2, "recording.* alone");
  expect_refused(grow + " --profile paper", 2, "recording.* alone");
}

TEST_F(Growing, WhatIsDamagedIsNamedAndNothingIsLost) {
  expect_done("slam " + drive("ahead") + " " + drive("behind") + " --out " + in("s"));
  const std::string toml = text_of("s/session.toml");
  const std::string map = text_of("s/ahead/map.adit");
  const std::string findings = text_of("s/fleet.adit");

  // Findings that were cut: the pair is tested again, to the same end.
  std::string other = findings;
  other.pop_back();
  put_file(folder_ / "s/fleet.adit", other);
  const test::ProgramRun run =
      run_adit("slam --session " + in("s") + " " + drive("later") + " --out " + in("anew"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("cut off; its pairs are tested anew"), std::string::npos) << run.err;
  put_file(folder_ / "s/fleet.adit", findings);
  // A map of another drive in the place of one: its findings are of other keyframes.
  expect_done("slam ahead=" + drive("later") + " --out " + in("other"));
  put_file(folder_ / "s/ahead/map.adit", text_of("other/ahead/map.adit"));
  const test::ProgramRun swapped =
      run_adit("slam --session " + in("s") + " " + drive("far") + " --out " + in("swapped"));
  EXPECT_NE(swapped.err.find("found with another map of ahead"), std::string::npos) << swapped.err;
  put_file(folder_ / "s/ahead/map.adit", map);
  expect_done("slam --session " + in("s") + " " + drive("later") + " --out " + in("grown"));
  expect_same_results("anew", "grown", {"ahead", "behind", "later"});

  put_file(folder_ / "s/ahead/map.adit", map.substr(0, map.size() / 2));
  expect_refused("slam --session " + in("s") + " " + drive("later"), 1, "ahead/map.adit");
  fs::remove_all(folder_ / "s/ahead");
  expect_refused("slam --session " + in("s") + " " + drive("later"), 1, "make it again with adit slam");
  EXPECT_EQ(text_of("s/session.toml"), toml);
  expect_refused("slam --session " + in("drives") + " " + drive("later"), 1, "not a session directory");
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// Two short drives through a mine, from the command line: slam, its provenance and rerun, evaluate, study,
// config.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "adit/io/session_dir.hpp"
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
using test::put_two_drives;
using test::run_adit;

/// Every file below the folder, by its path within it.
std::map<std::string, std::string> files_of(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files[fs::relative(entry.path(), folder).string()] = get_file(entry.path());
  return files;
}

void expect_same_files(const fs::path& a, const fs::path& b) {
  const auto left = files_of(a);
  const auto right = files_of(b);
  EXPECT_GE(left.size(), 13U);
  for (const auto& [name, bytes] : left) {
    ASSERT_TRUE(right.contains(name)) << name;
    EXPECT_TRUE(right.at(name) == bytes) << name << " differs";
  }
  EXPECT_EQ(left.size(), right.size());
}

TEST(Session, IsMadeAgainByteForByteFromItsProvenance) {
  const test::TemporaryFolder folder;
  put_two_drives(folder.path());
  const std::string routes = (folder / "routes.yaml").string();
  const std::string first = (folder / "a").string();
  expect_done("slam " + routes + " --lidar os2-32 --set robot.keyframes.distance_m=1 --keyframes all --out " +
              first);
  expect_done("slam --rerun " + first + "/session.toml --threads 1 --out " + (folder / "b").string());
  expect_same_files(first, folder / "b");

  const SavedSession session = read_session(first).value();
  const Provenance& provenance = session.provenance;
  EXPECT_EQ(provenance.command,
            "adit slam " + routes + " --lidar os2-32 --keyframes all --set robot.keyframes.distance_m=1");
  EXPECT_EQ(provenance.inputs, (std::vector<std::string>{routes}));
  EXPECT_EQ(provenance.world, (folder / "world.ply").string());
  EXPECT_EQ(provenance.profile, "default");
  EXPECT_EQ(provenance.settings, (std::vector<std::string>{"robot.keyframes.distance_m=1"}));
  ASSERT_EQ(provenance.robots.size(), 2U);
  EXPECT_EQ(provenance.robots[0].odometry, "plane-icp");
  EXPECT_EQ(provenance.robots[0].lidar, "os2-32");
  EXPECT_NE(provenance.configuration.find("keyframes = 'all'"), std::string::npos);
  EXPECT_NE(get_file(folder / "a/report.html").find("--set robot.keyframes.distance_m=1"), std::string::npos);

  expect_refused(
      "slam --rerun " + first + "/session.toml --set bus.loss=0.1 --out " + (folder / "c").string(), 2,
      "as it was");
  expect_refused("slam --out " + (folder / "c").string(), 2, "give recordings");
}

TEST(Session, IsEvaluatedByNameInAnyOrder) {
  const test::TemporaryFolder folder;
  put_two_drives(folder.path());
  const std::string routes = (folder / "routes.yaml").string();
  const std::string session = (folder / "session").string();
  const std::string recordings = (folder / "recordings").string();
  expect_done("slam " + routes + " --lidar os2-32 --out " + session);
  expect_done("simulate --routes " + routes + " --lidar os2-32 --set simulation.lidar.rate_hz=1 --out " +
              recordings);
  const std::string ahead = recordings + "/ahead_truth.tum";
  const std::string behind = recordings + "/behind_truth.tum";
  const test::ProgramRun run = run_adit("evaluate " + session + " --json --truth " + behind + " " + ahead);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json result = nlohmann::json::parse(run.out);
  ASSERT_EQ(result["robots"].size(), 2U);
  EXPECT_EQ(result["robots"][0]["name"], "ahead");
  for (const nlohmann::json& robot : result["robots"]) {
    EXPECT_LT(robot["ate_max_m"].get<double>(), 0.5) << robot;
    EXPECT_GT(robot["ate_rmse_m"].get<double>(), 0.0) << robot;
    EXPECT_LT(robot["rpe_translation_median_m"].get<double>(), 0.1) << robot;
    EXPECT_EQ(robot["rpe_segment_m"].get<double>(), 10.0);
  }
  EXPECT_EQ(result["components"].size(), 1U) << "both share a map";
  const nlohmann::json& in_use = result["loops"]["in_use"];
  EXPECT_GE(in_use["total"].get<int>(), 5);
  EXPECT_EQ(in_use["wrong_place"], 0);
  EXPECT_EQ(in_use["correct"], in_use["total"]);

  // The session says so from now on.
  EXPECT_EQ(nlohmann::json::parse(get_file(folder / "session/metrics.json"))["evaluation"], result);
  const std::string csv = get_file(folder / "session/loops.csv");
  std::size_t correct = 0;
  for (std::size_t at = csv.find(",correct,"); at != std::string::npos; at = csv.find(",correct,", at + 1))
    ++correct;
  EXPECT_EQ(correct, result["loops"]["registered"]["correct"].get<std::size_t>());

  EXPECT_TRUE(result["maps"].empty()) << "no mesh was given";

  const test::ProgramRun one = run_adit("evaluate " + session + " --truth ahead=" + ahead);
  EXPECT_EQ(one.exit_code, 0) << one.err;
  EXPECT_NE(one.err.find("behind has no truth"), std::string::npos) << one.err;
  fs::copy_file(ahead, folder / "other.tum");
  expect_refused("evaluate " + session + " --truth " + (folder / "other.tum").string(), 1,
                 "it names none of the robots ahead, behind");
  put_file(folder / "ahead.tum", "1000000000 0 0 0 0 0 0 1\n1000000001 1 0 0 0 0 0 1\n");
  expect_refused("evaluate " + session + " --truth " + (folder / "ahead.tum").string(), 1,
                 "not the truth of this drive");
}

void expect_near_the_mesh(const nlohmann::json& map) {
  EXPECT_GT(map["points"].get<int>(), 5000);
  EXPECT_LT(map["surface_median_m"].get<double>(), 0.08) << map;
  EXPECT_GT(map["surface_median_m"].get<double>(), 0.0) << map;
  EXPECT_LT(map["surface_p95_m"].get<double>(), 0.4) << map;
  EXPECT_GT(map["completeness_10cm_pct"].get<double>(), 20.0) << map;
  EXPECT_LT(map["completeness_10cm_pct"].get<double>(), 100.0) << map;
}

TEST(Session, ItsMapIsComparedWithTheMesh) {
  const test::TemporaryFolder folder;
  put_two_drives(folder.path());
  const std::string session = (folder / "session").string();
  const std::string recordings = (folder / "recordings").string();
  const std::string routes = (folder / "routes.yaml").string();
  const std::string mesh = " --mesh " + (folder / "world.ply").string();
  expect_done("slam " + routes + " --lidar os2-32 --out " + session);
  expect_done("simulate --routes " + routes + " --lidar os2-32 --set simulation.lidar.rate_hz=1 --out " +
              recordings);
  const std::string truths =
      " --truth " + recordings + "/ahead_truth.tum " + recordings + "/behind_truth.tum";
  const test::ProgramRun run = run_adit("evaluate " + session + truths + mesh + " --json");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json maps = nlohmann::json::parse(run.out)["maps"];
  ASSERT_EQ(maps.size(), 1U);
  expect_near_the_mesh(maps[0]);
  EXPECT_EQ(nlohmann::json::parse(get_file(folder / "session/metrics.json"))["evaluation"]["maps"], maps);
  EXPECT_NE(run_adit("evaluate " + session + truths + mesh).out.find("Map against the true surface"),
            std::string::npos);

  // The session's map as a cloud of its own: the same alignment, points that are thinned more.
  const std::string cloud = session + "/map.ply";
  const std::string trajectories =
      " --trajectory " + session + "/ahead/trajectory.tum " + session + "/behind/trajectory.tum";
  const test::ProgramRun aligned = run_adit("evaluate " + cloud + truths + trajectories + mesh + " --json");
  ASSERT_EQ(aligned.exit_code, 0) << aligned.err;
  const nlohmann::json map = nlohmann::json::parse(aligned.out);
  EXPECT_NEAR(map["surface_median_m"].get<double>(), maps[0]["surface_median_m"].get<double>(), 0.03);
  EXPECT_NEAR(map["could_be_seen_m2"].get<double>(), maps[0]["could_be_seen_m2"].get<double>(),
              0.1 * maps[0]["could_be_seen_m2"].get<double>());
  EXPECT_LT(map["completeness_10cm_pct"].get<double>(), maps[0]["completeness_10cm_pct"].get<double>());
  const test::ProgramRun alone = run_adit("evaluate " + cloud + mesh + " --json");
  ASSERT_EQ(alone.exit_code, 0) << alone.err;
  EXPECT_NE(alone.err.find("in the frame of the mesh"), std::string::npos) << alone.err;
  EXPECT_TRUE(nlohmann::json::parse(alone.out)["completeness_10cm_pct"].is_null());

  expect_refused("evaluate " + session, 2, "--truth is required");
  expect_refused("evaluate " + cloud + trajectories + mesh, 2, "each needs its truth");
  expect_refused("evaluate " + session + truths + " --mesh " + cloud, 1, "no triangle");
}

TEST(Session, ExplainsItsMerges) {
  const test::TemporaryFolder folder;
  put_two_drives(folder.path());
  const std::string session = (folder / "session").string();
  expect_done("slam " + (folder / "routes.yaml").string() + " --lidar os2-32 --out " + session);
  const test::ProgramRun text = run_adit("explain " + session + " ahead behind");
  ASSERT_EQ(text.exit_code, 0) << text.err;
  for (const char* part : {"ahead and behind: merged", "places along the shared stretch agree", "accepted"})
    EXPECT_NE(text.out.find(part), std::string::npos) << text.out;
  const nlohmann::json pairs = nlohmann::json::parse(run_adit("explain " + session + " behind --json").out);
  ASSERT_GE(pairs.size(), 1U);
  const nlohmann::json& best = pairs[0]["hypotheses"][0];
  EXPECT_TRUE(pairs[0]["merged"]);
  EXPECT_GE(best["evidence"].get<double>(), pairs[0]["evidence_needed"].get<double>());
  EXPECT_GT(best["places_agreeing"].get<int>(), 0);
  expect_refused("explain " + session + " nobody", 1, "no merge with a robot 'nobody' in it");
  expect_refused("explain " + folder.path().string(), 1, "not a session directory");
}

TEST(Session, ExplainsWhyItDidNotMergeAndWhereToDrive) {
  const test::TemporaryFolder folder;
  put_two_drives(folder.path());
  const std::string session = (folder / "session").string();
  // More evidence than a pair can have is asked for.
  expect_done("slam " + (folder / "routes.yaml").string() +
              " --lidar os2-32 --set loops.adaptive.merge_check.evidence.error_rate=1e-9 --out " + session);
  const test::ProgramRun text = run_adit("explain " + session + " ahead behind");
  ASSERT_EQ(text.exit_code, 0) << text.err;
  for (const char* part : {"ahead and behind: not merged (too little)", "evidence ", " of 20.7", "unsure"})
    EXPECT_NE(text.out.find(part), std::string::npos) << text.out;
  const nlohmann::json pair =
      nlohmann::json::parse(run_adit("explain " + session + " ahead behind --json").out)[0];
  EXPECT_FALSE(pair["merged"]);
  EXPECT_EQ(pair["refused_kind"], "too little");
  EXPECT_EQ(pair["hypotheses"][0]["outcome"], "unsure");
  ASSERT_TRUE(pair.contains("where_to_drive")) << pair["why"];
  EXPECT_GT(pair["where_to_drive"]["missing"].get<double>(), 0.0);
  EXPECT_NE(pair["why"].get<std::string>().find(" drive along the path of "), std::string::npos)
      << pair["why"];
}

TEST(Session, ExplainsWhatShareOfTheReturnsNothingConfirmed) {
  const test::TemporaryFolder folder;
  put_file(folder / "session.toml",
           "robots = ['ada', 'bo', 'cy']\n"
           "[[merges]]\nrobots = ['ada', 'bo']\nreason = 'scans differ'\n"
           "unconfirmed_a = 0.06\nunconfirmed_b = 0.22\n"
           "[[merges]]\nrobots = ['ada', 'cy']\nreason = 'no loop'\nunconfirmed_a = 0.01\n"
           "[[merges]]\nrobots = ['bo', 'cy']\nreason = 'no loop'\n"
           "unconfirmed_a = nan\nunconfirmed_b = 1.5\n");
  const std::string session = folder.path().string();
  const test::ProgramRun both = run_adit("explain " + session + " ada bo");
  ASSERT_EQ(both.exit_code, 0) << both.err;
  EXPECT_NE(both.out.find("  of the scans compared, 6 % of ada's returns and 22 % of bo's were confirmed by "
                          "no other return\n"),
            std::string::npos)
      << both.out;
  const test::ProgramRun clean = run_adit("explain " + session + " ada cy");
  EXPECT_EQ(clean.out.find("no other return"), std::string::npos) << clean.out;
  const nlohmann::json pairs = nlohmann::json::parse(run_adit("explain " + session + " ada --json").out);
  EXPECT_EQ(pairs.at(0)["unconfirmed"], nlohmann::json::parse("[0.06, 0.22]"));
  EXPECT_EQ(pairs.at(1)["unconfirmed"], nlohmann::json::parse("[0.01, null]"));
  const nlohmann::json edited = nlohmann::json::parse(run_adit("explain " + session + " bo cy --json").out);
  EXPECT_EQ(edited.at(0)["unconfirmed"], nlohmann::json::parse("[null, null]")) << "these are no shares";
}

TEST(Session, RobotsOfOneNameGetDifferentNames) {
  const test::TemporaryFolder folder;
  put_two_drives(folder.path());
  const auto recorded = [&](const std::string& seed) {
    const std::string recordings = (folder / ("recordings_" + seed)).string();
    expect_done("simulate --routes " + (folder / "routes.yaml").string() +
                " --robot ahead --lidar os2-32 --set simulation.lidar.columns=256 --seed " + seed +
                " --out " + recordings);
    return recordings + "/ahead.mcap";
  };
  const std::string file = recorded("1");
  const std::string other = recorded("2");
  const std::string slam = "slam --keyframes all --out " + (folder / "session").string();
  const test::ProgramRun twice = run_adit(slam + " " + file + " " + other);
  EXPECT_EQ(twice.exit_code, 0) << twice.err;
  EXPECT_NE(twice.err.find("'ahead'; here it is ahead_2"), std::string::npos) << twice.err;
  EXPECT_TRUE(fs::exists(folder / "session/ahead_2/trajectory.tum"));

  const std::string two_names = " ada=" + file + " bo=" + other;
  expect_refused(slam + two_names, 1, "the maps of ahead, ahead_2");
  const test::ProgramRun named = run_adit(slam + "_of_two" + two_names);
  EXPECT_EQ(named.exit_code, 0) << named.err;
  EXPECT_EQ(named.err, "");
  EXPECT_TRUE(fs::exists(folder / "session_of_two/ada/trajectory.tum"));
  EXPECT_TRUE(fs::exists(folder / "session_of_two/bo/trajectory.tum"));
  const test::ProgramRun again = run_adit(slam + "_of_one ada=" + file + " bo=" + file);
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_NE(again.err.find("bo is left out: it has the same map as ada"), std::string::npos) << again.err;
  EXPECT_FALSE(fs::exists(folder / "session_of_one/bo"));
}

TEST(Study, RunsThePapersExperimentAndSaysWhatRan) {
  const test::TemporaryFolder folder;
  put_two_drives(folder.path());
  const std::string command = "study --world " + (folder / "world.ply").string() + " --routes " +
                              (folder / "routes.yaml").string() + " --lidar os2-32 --keyframes all,adaptive";
  const test::ProgramRun run = run_adit(command + " --json --out " + (folder / "out").string());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const nlohmann::json metrics = nlohmann::json::parse(run.out);
  EXPECT_EQ(metrics, nlohmann::json::parse(get_file(folder / "out/metrics.json")));
  EXPECT_EQ(metrics["lidar"], "os2-32");
  ASSERT_EQ(metrics["robots"].size(), 2U);
  for (const nlohmann::json& robot : metrics["robots"]) {
    EXPECT_NEAR(robot["path_length_m"].get<double>(), 49.0, 3.0);
    EXPECT_GT(robot["scans"].get<int>(), 200);
    EXPECT_LT(robot["odometry"]["plane_icp"]["ate_max_m"].get<double>(), 0.5);
    EXPECT_TRUE(robot["odometry"].contains("kinematic_icp"));
    EXPECT_TRUE(robot["odometry"].contains("kiss_icp"));
  }
  ASSERT_EQ(metrics["pairs"].size(), 4U);  // two policies, without and with PCM
  const nlohmann::json& adaptive = metrics["pairs"][3];
  EXPECT_EQ(adaptive["keyframes"], "adaptive");
  EXPECT_EQ(adaptive["pcm"], true);
  EXPECT_EQ(adaptive["merged"], true) << adaptive["refused_reason"];
  EXPECT_EQ(adaptive["success"], true);
  EXPECT_EQ(adaptive["wrong_loops_in_solution"], 0);
  EXPECT_LT(adaptive["ate_max_over_path_pct"][0].get<double>(), 1.0);
  EXPECT_EQ(metrics["joint"]["components"].size(), 1U);

  const std::string page = get_file(folder / "out/report.html");
  EXPECT_NE(page.find("adit " + command), std::string::npos) << "made by";
  EXPECT_NE(page.find("keyframes all: odometry kinematic-icp"), std::string::npos);
  EXPECT_NE(page.find("keyframes adaptive: odometry plane-icp"), std::string::npos);
  for (const char* file : {"tables.md", "robots/ahead/truth.tum", "joint/session.toml", "joint/loops.csv",
                           "pairs/ahead-behind/adaptive/session.toml"})
    EXPECT_TRUE(fs::exists(folder / "out" / file)) << file;
  const SavedSession joint = read_session(folder / "out/joint").value();
  EXPECT_EQ(joint.provenance.command, "adit " + command);
}

TEST(Config, EveryCommandTakesWhatItPrintsAndDoesTheSame) {
  const test::TemporaryFolder folder;
  put_two_drives(folder.path());
  const test::ProgramRun printed = run_adit("config");
  ASSERT_EQ(printed.exit_code, 0) << printed.err;
  put_file(folder / "adit.toml", printed.out);
  const std::string config = " --config " + (folder / "adit.toml").string();
  EXPECT_EQ(run_adit("config" + config).out, printed.out);
  EXPECT_EQ(run_adit("config --profile default").out, printed.out);
  EXPECT_NE(run_adit("config --profile paper").out, printed.out);

  put_file(
      folder / "graph.g2o",
      "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 1 2 1 0 0 1 0 0 1 0 1\nEDGE_SE2 0 2 2.1 0 0 1 0 0 1 0 1\n");
  const std::string recording = (folder / "recording").string();
  const std::vector<std::string> commands = {
      "world --preset mine --out " + (folder / "OUT").string(),
      "simulate --routes " + (folder / "routes.yaml").string() + " --robot ahead --lidar vlp-16 --out " +
          (folder / "OUT").string(),
      "solve " + (folder / "graph.g2o").string() + " --out " + (folder / "OUT").string()};
  for (std::string command : commands) {
    expect_done(command);
    const auto plain = fs::is_directory(folder / "OUT")
                           ? files_of(folder / "OUT")
                           : std::map<std::string, std::string>{{"", get_file(folder / "OUT")}};
    fs::remove_all(folder / "OUT");
    expect_done(command + config);
    const auto configured = fs::is_directory(folder / "OUT")
                                ? files_of(folder / "OUT")
                                : std::map<std::string, std::string>{{"", get_file(folder / "OUT")}};
    EXPECT_TRUE(plain == configured) << command;
    fs::remove_all(folder / "OUT");
  }
}

TEST(Config, AWrongSettingIsWrongUsageInEveryCommand) {
  const test::TemporaryFolder folder;
  put_file(folder / "a", "");
  const std::string a = (folder / "a").string();
  const std::string out = " --out " + (folder / "out").string();
  const std::vector<std::string> commands = {"world" + out,
                                             "routes " + a + out,
                                             "simulate --routes " + a + out,
                                             "odometry " + a + out,
                                             "slam " + a + out,
                                             "study" + out,
                                             "merge-study --worlds " + a + out,
                                             "loop-study --graphs " + a + out,
                                             "evaluate " + a + " --truth " + a,
                                             "register " + a + " " + a,
                                             "solve " + a,
                                             "convert " + a + " " + a + ".ply",
                                             "info " + a,
                                             "config"};
  put_file(folder / "bad.toml", "[robot]\ncloud_voxle = 0.1\n");
  for (const std::string& command : commands) {
    expect_refused(command + " --set robot.cloud_voxel", 2, "key=value is needed");
    expect_refused(command + " --set robot.cloud_voxle=0.1", 2, "did you mean 'robot.cloud_voxel'?");
    expect_refused(command + " --set robot.cloud_voxel=99", 2, "outside 0.01 to 2 m");
    expect_refused(command + " --profile best", 2, "best");
    expect_refused(command + " --config " + (folder / "bad.toml").string(), 1, "robot.cloud_voxel");
  }
  EXPECT_FALSE(fs::exists(folder / "out"));
}

}  // namespace
}  // namespace adit

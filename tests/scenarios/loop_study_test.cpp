// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// `adit loop-study` on small graphs: what it counts, what it writes and what it refuses.
#include <gtest/gtest.h>

#include <regex>

#include "adit/core/ids.hpp"
#include "adit/io/g2o.hpp"
#include "support/files.hpp"
#include "support/laps.hpp"
#include "support/program.hpp"

namespace adit {
namespace {

using test::expect_done;
using test::expect_refused;
using test::get_file;
using test::put_file;

void put_graph(const std::filesystem::path& path, const PoseGraph& graph) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream file(path);
  write_g2o(file, graph);
}

/// One edge of a loop between two robots, in a file of its own as each robot writes it.
PoseGraph loop_between(std::uint64_t from_key, std::uint64_t to_key, const Pose& T_from_to) {
  return {{{from_key, Pose()}, {to_key, T_from_to}},
          {{0, 1, T_from_to, Matrix6::Identity() / (test::kLapSigma * test::kLapSigma), EdgeKind::loop}}};
}

std::string study(const test::TemporaryFolder& folder, const std::string& options = "") {
  return "loop-study --graphs " + (folder / "list.toml").string() + " --out " + (folder / "out").string() +
         " " + options;
}

std::string entry(const std::string& name, const std::string& path, const std::string& injection,
                  const std::string& more = "") {
  return "[[graph]]\nname = '" + name + "'\npath = '" + path + "'\ninjection = '" + injection + "'\n" + more +
         "\n";
}

/// Without the times, which no two runs share.
std::string timeless(const std::string& json) {
  return std::regex_replace(json, std::regex("\"time_s\": [^,]*,"), "");
}

TEST(LoopStudy, CountsWhatEachMethodKeepsAndLoses) {
  const test::TemporaryFolder folder;
  put_graph(folder / "laps.g2o", test::two_laps(0));
  put_file(folder / "list.toml", entry("laps", "laps.g2o", "random") +
                                     entry("laps", "laps.g2o", "clustered") +
                                     entry("away", "nowhere.g2o", "random"));
  put_file(folder / "page.md", "# Page\n<!-- false loops begin -->\n<!-- false loops end -->\nThe end.\n");
  const test::ProgramRun run =
      test::run_adit(study(folder, "--shares 20,50 --page " + (folder / "page.md").string()));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("away is left out"), std::string::npos) << run.err;
  const std::string page = get_file(folder / "page.md");
  EXPECT_TRUE(page.starts_with("# Page\n<!-- false loops begin -->\n"));
  EXPECT_TRUE(page.ends_with("<!-- false loops end -->\nThe end.\n"));
  EXPECT_NE(page.find("| laps | random | 20 | 40 | 10 |"), std::string::npos) << page;
  EXPECT_NE(page.find("| laps | random | 50 | 40 | 40 |"), std::string::npos) << page;
  EXPECT_NE(page.find("| laps | clustered | 50 | 40 | 40 |"), std::string::npos) << page;
  EXPECT_EQ(page.find("away"), std::string::npos);
  EXPECT_EQ(page.find("Methods without an answer"), std::string::npos) << page;
  // Random false loops are easy: adit keeps none and loses nothing.
  const std::string json = get_file(folder / "out/false_loops.json");
  const std::string ours = json.substr(json.find("\"adit\""), 120);
  EXPECT_NE(ours.find("\"true_kept\": 40,"), std::string::npos) << ours;
  EXPECT_NE(ours.find("\"false_kept\": 0,"), std::string::npos) << ours;
  EXPECT_NE(ours.find("\"false_rejected\": 10,"), std::string::npos) << ours;
}

TEST(LoopStudy, SaysTheSameAgainAndAsJson) {
  const test::TemporaryFolder folder;
  put_graph(folder / "data/laps.g2o", test::two_laps(0));
  put_file(folder / "list.toml", entry("laps", "laps.g2o", "clustered", "seed = 5\nkeep_every = 2"));
  const std::string data = " --data " + (folder / "data").string();
  const test::ProgramRun run = test::run_adit(study(folder, "--json --shares 30" + data));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.out, get_file(folder / "out/false_loops.json"));
  EXPECT_NE(run.out.find("\"true_loops\": 20"), std::string::npos) << run.out;
  const test::ProgramRun again = test::run_adit(study(folder, "--json --threads 1 --shares 30" + data));
  EXPECT_EQ(timeless(again.out), timeless(run.out));
}

TEST(LoopStudy, FindsFalseLoopsOfRobotsOnAFloorByTheirTilt) {
  const test::TemporaryFolder folder;
  const std::uint64_t a = graph_key({{0}, 0});
  const std::uint64_t b = graph_key({{1}, 0});
  put_graph(folder / "fleet/0.g2o", test::two_laps(a));
  put_graph(folder / "fleet/1.g2o", test::two_laps(b));
  for (std::uint64_t k = 0; k < 8; ++k) {
    const bool is_false = k == 5;
    const Pose error = is_false ? Pose::exp((Vector6() << 3.0, 0.0, 2.0, 1.0, 0.0, 0.0).finished()) : Pose();
    put_graph(folder / ("fleet/loop_" + std::to_string(k) + ".g2o"), loop_between(a + k, b + k, error));
  }
  put_file(folder / "list.toml", entry("fleet", "fleet", "as found", "max_tilt_deg = 10.0"));
  expect_done(study(folder));
  const std::string json = get_file(folder / "out/false_loops.json");
  EXPECT_NE(json.find("\"true_loops\": 87,"), std::string::npos) << json;
  EXPECT_NE(json.find("\"false_loops\": 1,"), std::string::npos) << json;
  const std::string ours = json.substr(json.find("\"adit\""));
  EXPECT_NE(ours.find("\"true_kept\": 87,"), std::string::npos) << ours;
  EXPECT_NE(ours.find("\"false_rejected\": 1,"), std::string::npos) << ours;
}

TEST(LoopStudy, WhereAMethodHasNoAnswerThePageSaysWhy) {
  const test::TemporaryFolder folder;
  put_file(
      folder / "flat.g2o",
      "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 1 2 1 0 0 1 0 0 1 0 1\nEDGE_SE2 0 2 2 0 0 1 0 0 1 0 1\n");
  put_file(folder / "list.toml", entry("flat", "flat.g2o", "random"));
  const test::ProgramRun run = test::run_adit(study(folder, "--shares 0"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("Methods without an answer"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("this one is 2-D"), std::string::npos) << run.out;
}

TEST(LoopStudy, WrongListsAreRefusedWithTheFileAndTheRemedy) {
  const test::TemporaryFolder folder;
  put_graph(folder / "laps.g2o", test::two_laps(0));
  const auto expect_list_refused = [&](const std::string& list, const std::string& text) {
    put_file(folder / "list.toml", list);
    expect_refused(study(folder), 1, text);
    EXPECT_NE(test::run_adit(study(folder)).err.find("list.toml"), std::string::npos) << text;
  };
  expect_list_refused("[[graph]]\npath = 'laps.g2o'\n", "no name; add name");
  expect_list_refused("[[graph]]\nname = 'a'\n", "no path; add path");
  expect_list_refused(entry("a", "laps.g2o", "random") + entry("a", "laps.g2o", "random"), "rename one");
  expect_list_refused(entry("a", "laps.g2o", "as found"), "add it");
  expect_list_refused(entry("a", "laps.g2o", "random", "max_tilt_deg = 5.0"), "or remove it");
  expect_list_refused(entry("a", "laps.g2o", "many"), "clustered");
  expect_list_refused(entry("a", "laps.g2o", "random", "keep_evry = 5"), "keep_every");
  expect_list_refused(entry("a", "laps.g2o", "random", "keep_every = 0"), "keep_every");
  put_file(folder / "list.toml", entry("a", "laps.g2o", "random"));
  expect_refused(study(folder, "--only b"), 1, "no graph 'b'");
  expect_refused(study(folder, "--shares 100"), 2, "100");
  std::filesystem::create_directories(folder / "empty");
  put_file(folder / "list.toml", entry("a", "empty", "random"));
  expect_refused(study(folder), 1, "holds no .g2o file");
}

}  // namespace
}  // namespace adit

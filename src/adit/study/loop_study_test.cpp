// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/loop_study.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "support/files.hpp"
#include "support/laps.hpp"

namespace adit {
namespace {

using test::put_file;

constexpr std::size_t kGnc = 0;
constexpr std::size_t kPcm = 1;
constexpr std::size_t kAdit = 2;

void put_graph(const std::filesystem::path& path, const PoseGraph& graph) {
  std::ofstream file(path);
  write_g2o(file, graph);
}

/// What the study reports of a graph, in order.
std::vector<FalseLoopRun> runs_of(const ListedGraph& graph, std::vector<int> shares) {
  std::vector<FalseLoopRun> runs;
  LoopStudy study;
  study.shares = std::move(shares);
  study.on_run = [&](FalseLoopRun run) { runs.push_back(std::move(run)); };
  const Result<> done = run_graph(graph, study);
  EXPECT_TRUE(done) << done.error().message;
  return runs;
}

ListedGraph listed_graph(const std::string& name, const std::string& path) {
  ListedGraph graph;
  graph.name = name;
  graph.path = path;
  return graph;
}

ListedGraph laps_in(const test::TemporaryFolder& folder) {
  put_graph(folder / "laps.g2o", test::two_laps(0));
  return listed_graph("laps", (folder / "laps.g2o").string());
}

TEST(RunGraph, WithoutFalseLoopsNoMethodMovesTheMap) {
  const test::TemporaryFolder folder;
  const std::vector<FalseLoopRun> runs = runs_of(laps_in(folder), {0});
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_EQ(runs[0].num_false, 0);
  EXPECT_EQ(runs[0].num_nodes, static_cast<int>(2 * test::kLapNodes));
  for (const std::size_t method : {kGnc, kAdit}) {
    ASSERT_TRUE(runs[0].decisions[method].has_value()) << runs[0].reasons[method];
    EXPECT_EQ(runs[0].decisions[method]->score, (LoopScore{40, 0, 0, 0}));
    EXPECT_LT(runs[0].decisions[method]->off_m, 1e-3);
    EXPECT_EQ(runs[0].decisions[method]->parts, 1);
  }
}

TEST(RunGraph, EveryShareIsReportedInOrderAndEveryLoopIsCounted) {
  const test::TemporaryFolder folder;
  const std::vector<FalseLoopRun> runs = runs_of(laps_in(folder), {50, 20});
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0].share_pct, 50);
  EXPECT_EQ(runs[0].num_false, 40);
  EXPECT_EQ(runs[1].share_pct, 20);
  EXPECT_EQ(runs[1].num_false, 10);
  for (const FalseLoopRun& run : runs) {
    EXPECT_EQ(run.graph, "laps");
    EXPECT_EQ(run.injection, "random");
    EXPECT_EQ(run.num_true, 40);
    for (const auto& decision : run.decisions) {
      ASSERT_TRUE(decision.has_value());
      EXPECT_EQ(decision->score.num_true(), run.num_true);
      EXPECT_EQ(decision->score.num_false(), run.num_false);
    }
    EXPECT_EQ(run.decisions[kAdit]->score.false_kept, 0);
    EXPECT_LT(run.decisions[kAdit]->off_m, 0.01);
  }
}

TEST(RunGraph, TheSeedDrawsTheFalseLoops) {
  const test::TemporaryFolder folder;
  ListedGraph graph = laps_in(folder);
  graph.injection = "clustered";
  const auto off_m = [&] { return runs_of(graph, {70})[0].decisions[kGnc]->off_m; };
  const double first = off_m();
  EXPECT_EQ(off_m(), first);
  graph.seed = 2;
  EXPECT_NE(off_m(), first);
}

TEST(RunGraph, OfLargeGraphsOthersAreLeftOutWithAReason) {
  const test::TemporaryFolder folder;
  ListedGraph graph = laps_in(folder);
  graph.large = true;
  graph.keep_every = 4;
  const std::vector<FalseLoopRun> runs = runs_of(graph, {50});
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_EQ(runs[0].num_true, 10);
  EXPECT_EQ(runs[0].num_false, 10);
  for (const std::size_t method : {kGnc, kPcm}) {
    EXPECT_FALSE(runs[0].decisions[method].has_value());
    EXPECT_NE(runs[0].reasons[method].find("listed as large"), std::string::npos);
  }
  EXPECT_TRUE(runs[0].decisions[kAdit].has_value());
  EXPECT_EQ(runs[0].reasons[kAdit], "");
}

TEST(RunGraph, OfAGraphAsFoundTiltedLoopsAreFalse) {
  const test::TemporaryFolder folder;
  PoseGraph graph = test::two_laps(0);
  for (std::size_t k = 0; k < 10; ++k) {  // every fifth of what are then 50 loops
    graph.edges.push_back(graph.edges[2 * test::kLapNodes - 1 + k]);
    graph.edges.back().T_from_to =
        graph.edges.back().T_from_to * Pose::exp((Vector6() << 1, 0, 2, 0.5, 0, 0).finished());
  }
  put_graph(folder / "found.g2o", graph);
  ListedGraph listed = listed_graph("found", (folder / "found.g2o").string());
  listed.injection = "as found";
  listed.max_tilt_deg = 10.0;
  const std::vector<FalseLoopRun> runs = runs_of(listed, {10, 30});
  ASSERT_EQ(runs.size(), 1U) << "the file has its own share";
  EXPECT_EQ(runs[0].share_pct, 20);
  EXPECT_EQ(runs[0].num_true, 40);
  EXPECT_EQ(runs[0].num_false, 10);
  EXPECT_EQ(runs[0].decisions[kAdit]->score, (LoopScore{40, 0, 0, 10}));
  listed.max_tilt_deg = 80.0;
  EXPECT_EQ(runs_of(listed, {}).at(0).num_false, 0);
}

TEST(RunGraph, PlaneGraphsHaveNoPcmAndNoTilt) {
  const test::TemporaryFolder folder;
  put_file(
      folder / "flat.g2o",
      "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 1 2 1 0 0 1 0 0 1 0 1\nEDGE_SE2 0 2 2 0 0 1 0 0 1 0 1\n");
  ListedGraph flat = listed_graph("flat", (folder / "flat.g2o").string());
  const std::vector<FalseLoopRun> runs = runs_of(flat, {0});
  ASSERT_EQ(runs.size(), 1U);
  EXPECT_FALSE(runs[0].decisions[kPcm].has_value());
  EXPECT_NE(runs[0].reasons[kPcm].find("2-D"), std::string::npos);
  EXPECT_EQ(runs[0].decisions[kAdit]->score, (LoopScore{1, 0, 0, 0}));
  flat.injection = "as found";
  flat.max_tilt_deg = 10.0;
  EXPECT_ERROR(run_graph(flat, {}), "flat.g2o: loops can be labelled by their tilt in 3-D graphs only");
  flat.path = (folder / "away.g2o").string();
  EXPECT_ERROR(run_graph(flat, {}), "away.g2o");
}

TEST(ChosenGraphs, KeepTheOrderOfTheListAndSayWhatIsAbsent) {
  const test::TemporaryFolder folder;
  const std::string there = (folder / "a.g2o").string();
  put_file(there, "");
  const std::vector<ListedGraph> list = {listed_graph("c", there), listed_graph("b", "nowhere.g2o"),
                                         listed_graph("a", there)};
  const auto all = chosen_graphs("list.toml", list, {});
  ASSERT_TRUE(all) << all.error().message;
  ASSERT_EQ(all->graphs.size(), 2U);
  EXPECT_EQ(all->graphs[0].name, "c");
  EXPECT_EQ(all->graphs[1].name, "a");
  EXPECT_EQ(all->notes, std::vector<std::string>{"b is left out: nowhere.g2o is absent"});
  const auto some = chosen_graphs("list.toml", list, {"a", "c"});
  ASSERT_TRUE(some) << some.error().message;
  EXPECT_EQ(some->graphs[0].name, "c") << "not in the order asked for";
  EXPECT_TRUE(some->notes.empty()) << "b was not asked for";
  EXPECT_ERROR(chosen_graphs("list.toml", list, {"a", "x"}), "list.toml: there is no graph 'x'; ");
}

/// Figures of one method, none for the others.
FalseLoopRun made_up_run() {
  FalseLoopRun run;
  run.graph = "laps";
  run.injection = "random";
  run.num_nodes = 80;
  run.num_true = 40;
  run.num_false = 10;
  run.share_pct = 20;
  run.decisions[kAdit] = LoopDecision{{37, 3, 2, 8}, 2, 1, 0.125, 1.5, false, 4};
  run.reasons[kPcm] = "it is plane";
  return run;
}

TEST(FalseLoopResults, OneLineHoldsTheFiguresAndADashWhereThereAreNone) {
  const std::string line = summary_line(made_up_run());
  EXPECT_NE(line.find("20 % of   50 loops false"), std::string::npos) << line;
  EXPECT_NE(line.find("plain GNC -;"), std::string::npos) << line;
  EXPECT_NE(line.find("adit 2 false kept, 3 true lost, 4 refused, 0.125 m off, 1.50 s;"), std::string::npos)
      << line;
  EXPECT_EQ(line.find('\n'), std::string::npos);
}

TEST(FalseLoopResults, JsonHoldsEveryRunInOrder) {
  FalseLoopRun second = made_up_run();
  second.graph = "a \"quoted\" name";
  const auto json = nlohmann::json::parse(json_of(std::vector{made_up_run(), second}));
  ASSERT_EQ(json["runs"].size(), 2U);
  EXPECT_EQ(json["runs"][1]["graph"], "a \"quoted\" name");
  const auto& run = json["runs"][0];
  EXPECT_EQ(run["share_pct"], 20);
  EXPECT_EQ(run["nodes"], 80);
  EXPECT_EQ(run["true_loops"], 40);
  EXPECT_EQ(run["false_loops"], 10);
  EXPECT_EQ(run["PCM"], (nlohmann::json{{"reason", "it is plane"}}));
  EXPECT_EQ(run["adit"], (nlohmann::json{{"true_kept", 37},
                                         {"true_lost", 3},
                                         {"false_kept", 2},
                                         {"false_rejected", 8},
                                         {"refused", 4},
                                         {"parts", 2},
                                         {"possible_parts", 1},
                                         {"off_m", 0.125},
                                         {"time_s", 1.5},
                                         {"optimal", false}}));
}

}  // namespace
}  // namespace adit

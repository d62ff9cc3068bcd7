// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/loop_graphs.hpp"

#include <gtest/gtest.h>

#include "support/files.hpp"

namespace adit {
namespace {

using test::put_file;

/// Three nodes in a row with a chord; its loop has the information `loop_information` in x.
std::string triangle(double loop_information = 4.0) {
  return "EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\nEDGE_SE2 1 2 1 0 0 1 0 0 1 0 1\nEDGE_SE2 0 2 2 0 0 " +
         std::to_string(loop_information) + " 0 0 1 0 1\n";
}

const std::string kMinimal = "[[graph]]\nname = 'a'\npath = 'a.g2o'\n";

Result<std::vector<ListedGraph>> graphs_of(const test::TemporaryFolder& folder, const std::string& toml,
                                           const std::filesystem::path& data = {}) {
  put_file(folder / "list.toml", toml);
  return read_graph_list(folder / "list.toml", data);
}

TEST(GraphList, KeepsTheOrderOfTheFileAndFillsInDefaults) {
  const test::TemporaryFolder folder;
  const auto graphs = graphs_of(folder,
                                "[[graph]]\nname = 'z'\npath = 'z.g2o'\ninjection = 'clustered'\nseed = 7\n"
                                "keep_every = 10\ninformation_scale = 0.5\nlarge = true\n" +
                                    kMinimal +
                                    "[[graph]]\nname = 'm'\npath = 'm'\ninjection = 'as found'\n"
                                    "max_tilt_deg = 12.5\n");
  ASSERT_TRUE(graphs) << graphs.error().message;
  ASSERT_EQ(graphs->size(), 3U);
  const ListedGraph& z = graphs->at(0);
  EXPECT_EQ(z.name, "z");
  EXPECT_EQ(z.injection, "clustered");
  EXPECT_EQ(z.seed, 7U);
  EXPECT_EQ(z.keep_every, 10U);
  EXPECT_EQ(z.information_scale, 0.5);
  EXPECT_TRUE(z.large);
  const ListedGraph& a = graphs->at(1);
  EXPECT_EQ(a.name, "a");
  EXPECT_EQ(a.injection, "random");
  EXPECT_EQ(a.seed, 1U);
  EXPECT_EQ(a.keep_every, 1U);
  EXPECT_EQ(a.information_scale, 1.0);
  EXPECT_FALSE(a.large);
  EXPECT_EQ(graphs->at(2).max_tilt_deg, 12.5);
}

TEST(GraphList, PathsStandBehindTheDataFolderOrTheListsOwn) {
  const test::TemporaryFolder folder;
  const std::string toml = "[[graph]]\nname = 'a'\npath = '../x/./a.g2o'\n";
  EXPECT_EQ(graphs_of(folder, toml, "/data/g2o")->at(0).path, "/data/x/a.g2o");
  EXPECT_EQ(graphs_of(folder, toml)->at(0).path, (folder.path().parent_path() / "x/a.g2o").string());
  EXPECT_EQ(graphs_of(folder, "[[graph]]\nname = 'a'\npath = '/else/a.g2o'\n", "/data")->at(0).path,
            "/else/a.g2o");
}

TEST(GraphList, OneNameMayStandForSeveralInjectionsButNotTwiceForOne) {
  const test::TemporaryFolder folder;
  const auto both = graphs_of(folder, kMinimal + kMinimal + "injection = 'clustered'\n");
  ASSERT_TRUE(both) << both.error().message;
  EXPECT_EQ(both->size(), 2U);
  EXPECT_ERROR(graphs_of(folder, kMinimal + kMinimal),
               "list.toml: two entries are called 'a' with injection 'random'; rename one");
}

TEST(GraphList, ErrorsNameTheFileAndTheRemedy) {
  const test::TemporaryFolder folder;
  EXPECT_ERROR(graphs_of(folder, "[[graph]]\npath = 'a.g2o'\n"), "list.toml: an entry has no name; add name");
  EXPECT_ERROR(graphs_of(folder, "[[graph]]\nname = 'a'\n"), "list.toml: a has no path; add path");
  EXPECT_ERROR(graphs_of(folder, kMinimal + "injection = 'as found'\n"), "list.toml: a: max_tilt_deg");
  EXPECT_ERROR(graphs_of(folder, kMinimal + "max_tilt_deg = 5.0\n"), "list.toml: a: max_tilt_deg");
  EXPECT_ERROR(graphs_of(folder, kMinimal + "keep_every = 0\n"), "list.toml: line 4");
  EXPECT_ERROR(graphs_of(folder, kMinimal + "injection = 'many'\n"), "random, clustered, as found");
  EXPECT_ERROR(graphs_of(folder, "[graph]\nname = 'a'\n"), "list of [[graph]]");
  EXPECT_ERROR(read_graph_list(folder / "away.toml", {}), "away.toml");
}

ListedGraph listed(const std::filesystem::path& path) {
  ListedGraph graph;
  graph.name = "a";
  graph.path = path.string();
  return graph;
}

/// Of a plane graph.
PoseGraph2::Edge edge_of(const G2oFile& file, std::size_t edge) {
  return std::get<PoseGraph2>(file.graph).edges.at(edge);
}

TEST(ReadListed, ScalesEveryInformationMatrixAndNothingElse) {
  const test::TemporaryFolder folder;
  put_file(folder / "a.g2o", triangle());
  ListedGraph graph = listed(folder / "a.g2o");
  const Result<G2oFile> as_written = read_listed(graph);
  graph.information_scale = 0.25;
  graph.keep_every = 100;  // thinning is left to the study
  const Result<G2oFile> scaled = read_listed(graph);
  ASSERT_TRUE(as_written && scaled);
  ASSERT_EQ(std::get<PoseGraph2>(scaled->graph).edges.size(), 3U);
  for (std::size_t e = 0; e < 3; ++e) {
    EXPECT_EQ(edge_of(*scaled, e).information, (0.25 * edge_of(*as_written, e).information).eval()) << e;
    EXPECT_EQ(edge_of(*scaled, e).T_from_to.translation(), edge_of(*as_written, e).T_from_to.translation());
    EXPECT_EQ(edge_of(*scaled, e).kind, edge_of(*as_written, e).kind);
  }
}

TEST(ReadListed, AFolderIsOneGraphOfAllItsFiles) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "fleet");
  put_file(folder / "fleet/1.g2o",
           "VERTEX_SE2 1 9 9 0\nVERTEX_SE2 2 2 0 0\nEDGE_SE2 1 2 1 0 0 1 0 0 1 0 1\n");
  put_file(folder / "fleet/0.g2o",
           "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n");
  put_file(folder / "fleet/notes.txt", "no graph");
  const Result<G2oFile> merged = read_listed(listed(folder / "fleet"));
  ASSERT_TRUE(merged) << merged.error().message;
  const auto& graph = std::get<PoseGraph2>(merged->graph);
  EXPECT_EQ(graph.nodes.size(), 3U);
  EXPECT_EQ(graph.edges.size(), 2U);
  const auto shared = std::ranges::find(graph.nodes, 1U, &PoseGraph2::Node::key);
  ASSERT_NE(shared, graph.nodes.end());
  EXPECT_EQ(shared->pose.translation().x(), 1.0) << "the first file by name counts";
}

TEST(ReadListed, RefusesWhatCannotBeMeasuredByItsPath) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "empty");
  EXPECT_ERROR(read_listed(listed(folder / "empty")),
               "empty: the folder holds no .g2o file; name one that does");
  EXPECT_ERROR(read_listed(listed(folder / "away.g2o")), "away.g2o");
  put_file(folder / "bad.g2o", triangle(-4.0));
  EXPECT_ERROR(read_listed(listed(folder / "bad.g2o")),
               "bad.g2o: 1 information matrices are indefinite; repair the file");
  put_file(folder / "empty/half.g2o", "EDGE_SE2 0 1 1 0\n");
  EXPECT_ERROR(read_listed(listed(folder / "empty")), "half.g2o");
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/g2o.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "adit/posegraph/optimizer.hpp"
#include "support/data.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

Result<G2oFile> read(const std::string& text) {
  std::istringstream stream(text);
  return read_g2o(stream, "test.g2o");
}
std::string error_of(const std::string& text) {
  const auto file = read(text);
  return file ? std::string() : file.error().message;
}
std::string written(const G2oFile& file) {
  std::ostringstream stream;
  std::visit([&](const auto& graph) { write_g2o(stream, graph); }, file.graph);
  return stream.str();
}

TEST(G2o, ReadsEdgesBeforeVerticesAndComposesMissingOnes) {
  const auto file = read(
      "FIX 0\n# comment\nEDGE_SE2 0 1 1 0 0 1 0 0 2 0 3\nEDGE_SE2 1 2 1 0 0 1 2 3 4 5 6\r\n\nVERTEX_SE2 0 5 "
      "0 0");
  ASSERT_TRUE(file) << file.error().message;
  const auto& graph = std::get<PoseGraph2>(file->graph);
  ASSERT_EQ(graph.nodes.size(), 3U);
  EXPECT_EQ(graph.nodes[2].pose.translation().x(), 7.0);
  EXPECT_EQ(graph.edges[1].information, (Matrix3() << 1, 2, 3, 2, 4, 5, 3, 5, 6).finished());
  EXPECT_EQ(file->edge_lines, (std::vector<std::size_t>{3, 4}));
  EXPECT_EQ(file->notes.size(), 2U);
}

TEST(G2o, TellsOdometryFromLoopsByConsecutiveKeys) {
  const auto file =
      read("EDGE_SE2 3 4 1 0 0 1 0 0 1 0 1\nEDGE_SE2 4 3 1 0 0 1 0 0 1 0 1\nEDGE_SE2 3 5 1 0 0 1 0 0 1 0 1");
  ASSERT_TRUE(file);
  const auto& edges = std::get<PoseGraph2>(file->graph).edges;
  EXPECT_EQ(edges[0].kind, EdgeKind::odometry);
  EXPECT_EQ(edges[1].kind, EdgeKind::loop);
  EXPECT_EQ(edges[2].kind, EdgeKind::loop);
}

TEST(G2o, NamesTheLineOfWhatItCannotRead) {
  EXPECT_EQ(error_of("VERTEX_SE2 0 0 0 0\nLANDMARK 3").find("test.g2o: line 2: unknown tag 'LANDMARK'"), 0U);
  EXPECT_NE(error_of("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 0 0 0 0").find("comes twice"), std::string::npos);
  EXPECT_NE(error_of("VERTEX_SE2 0 0 0").find("missing"), std::string::npos);
  EXPECT_NE(error_of("VERTEX_SE2 0 0 0 0 1").find("too many"), std::string::npos);
  EXPECT_NE(error_of("VERTEX_SE2 0 0 x 0").find("'x'"), std::string::npos);
  EXPECT_NE(error_of("VERTEX_SE2 0 0 nan 0").find("not finite"), std::string::npos);
  EXPECT_NE(error_of("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 2").find("norm"), std::string::npos);
  EXPECT_NE(error_of("EDGE_SE2 1 1 0 0 0 1 0 0 1 0 1").find("itself"), std::string::npos);
  EXPECT_NE(error_of("VERTEX_SE2 0 0 0 0\nVERTEX_SE3:QUAT 1 0 0 0 0 0 0 1").find("both"), std::string::npos);
  EXPECT_FALSE(error_of("").empty());
}

void expect_cost(const std::string& name, double cost) {
  const auto file = read_g2o(test::shared_data("g2o/single/" + name));
  ASSERT_TRUE(file) << file.error().message;
  std::visit(
      [&](const auto& graph) {
        const auto solution = optimize(graph);
        EXPECT_EQ(solution.status, SolveStatus::converged) << solution.reason;
        EXPECT_LT(solution.cost_final, cost * (1.0 + 1e-6));
      },
      file->graph);
  const std::string text = written(*file);
  const auto again = read(text);
  ASSERT_TRUE(again);
  EXPECT_EQ(written(*again), text);
}

#define ADIT_COST_TEST(name, file, cost) \
  TEST(SharedGraphs, name) {             \
    ADIT_NEED_DATA("g2o/single/" file);  \
    expect_cost(file, cost);             \
  }
ADIT_COST_TEST(TinyGrid, "tinyGrid3D.g2o", 18.616158)
ADIT_COST_TEST(SmallGrid, "smallGrid3D.g2o", 1033.8945)
ADIT_COST_TEST(ParkingGarage, "parking-garage.g2o", 1.268384)
ADIT_COST_TEST(Sphere, "sphere2500.g2o", 1351.3623)
ADIT_COST_TEST(Torus, "torus3D.g2o", 24233.019)
ADIT_COST_TEST(Intel, "intel.g2o", 45.004696)
ADIT_COST_TEST(Manhattan, "manhattan.g2o", 3549.0368)
ADIT_COST_TEST(Kitti, "kitti_00.g2o", 98.322012)
ADIT_COST_TEST(City, "city10000.g2o", 511.985164)

TEST(SharedGraphs, CubicleIsRefused) {
  ADIT_NEED_DATA("g2o/single/cubicle.g2o");
  const auto file = read_g2o(test::shared_data("g2o/single/cubicle.g2o"));
  ASSERT_TRUE(file);
  const auto& graph = std::get<PoseGraph>(file->graph);
  EXPECT_EQ(graph.edges.size(), 16869U);
  EXPECT_EQ(indefinite_edges(graph).size(), 5021U);
}

TEST(SharedGraphs, RobotsOfOneFleetMerge) {
  ADIT_NEED_DATA("g2o/multi/example_4robots/0.g2o");
  std::vector<G2oFile> files;
  for (const char* name : {"0", "1", "2", "3"}) {
    auto file = read_g2o(test::shared_data(std::string("g2o/multi/example_4robots/") + name + ".g2o"));
    ASSERT_TRUE(file) << file.error().message;
    files.push_back(*file);
  }
  const auto merged = merge_g2o(files);
  ASSERT_TRUE(merged);
  const auto& graph = std::get<PoseGraph>(merged->graph);
  EXPECT_EQ(connected_components(graph).anchors.size(), 1U);
  EXPECT_TRUE(optimize(graph).ok());
}

TEST(G2o, PosesThatOverflowWhenComposedAreRefused) {
  EXPECT_NE(error_of("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1.7e308 0 0")
                .find("test.g2o: line 2: 1.7e+308 is not a coordinate"),
            std::string::npos);
  EXPECT_NE(error_of("EDGE_SE2 0 1 0 -2e9 0 1 0 0 1 0 1").find("-2000000000 is not"), std::string::npos);
  EXPECT_NE(error_of("VERTEX_SE3:QUAT 0 0 0 1e10 0 0 0 1").find("line 1: 10000000000 is not"),
            std::string::npos);
}

TEST(G2o, AFolderIsNamedAsOne) {
  const test::TemporaryFolder folder;
  EXPECT_ERROR(read_g2o(folder.path()), "is a folder, a file is needed");
  EXPECT_ERROR(read_g2o(folder / "absent.g2o"), "absent.g2o: no such file");
}

}  // namespace
}  // namespace adit

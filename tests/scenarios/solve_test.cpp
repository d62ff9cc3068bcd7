// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// `adit solve` on the graphs that everybody measures with, and on files that are wrong.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "adit/core/rng.hpp"
#include "adit/io/g2o.hpp"
#include "adit/posegraph/factors.hpp"
#include "adit/posegraph/optimizer.hpp"
#include "support/data.hpp"
#include "support/graphs.hpp"
#include "support/program.hpp"

namespace adit {
namespace {

nlohmann::json solved(const std::string& arguments) {
  const test::ProgramRun run = test::run_adit("solve --json " + arguments);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return nlohmann::json::parse(run.out, nullptr, false);
}

std::string single(const std::string& name) {
  return test::shared_data("g2o/single/" + name + ".g2o").string();
}

struct Benchmark {
  const char* name;
  double cost;  // chi2, unhalved
};
class SolveShared : public ::testing::TestWithParam<Benchmark> {};

// The best costs that Ceres and GTSAM reach, where these were measured; for the others ours, to notice
// changes.
INSTANTIATE_TEST_SUITE_P(
    Graphs, SolveShared,
    ::testing::Values(Benchmark{"sphere2500", 1351.3623}, Benchmark{"parking-garage", 1.268384},
                      Benchmark{"torus3D", 24233.019}, Benchmark{"smallGrid3D", 1033.8945},
                      Benchmark{"tinyGrid3D", 18.616158}, Benchmark{"intel", 45.004696},
                      Benchmark{"MIT", 41.163269}, Benchmark{"manhattan", 3549.036796},
                      Benchmark{"city10000", 511.985164}, Benchmark{"kitti_00", 98.322012}),
    [](const auto& graph) {
      std::string name = graph.param.name;
      std::erase(name, '-');
      return name;
    });

TEST_P(SolveShared, ReachesTheBestKnownCost) {
  const auto [name, cost] = GetParam();
  ADIT_NEED_DATA(std::string("g2o/single/") + name + ".g2o");
  const nlohmann::json r = solved(single(name));
  EXPECT_EQ(r["status"], "converged");
  EXPECT_NEAR(r["cost_final"].get<double>(), cost, 1e-4 * cost);
  EXPECT_LE(r["iterations"].get<int>(), 20);
  EXPECT_EQ(r["certificate"]["status"], "globally optimal") << r["certificate"];
  EXPECT_LT(r["certificate"]["gap"].get<double>(), 1e-4);
}

// MIT has hardly any loops, so that its minimum is flat: another start must end in the same one.
TEST(SolveSharedGraphs, MitHasOneMinimumAround) {
  ADIT_NEED_DATA("g2o/single/MIT.g2o");
  const test::TemporaryFolder folder;
  solved(single("MIT") + " --out " + (folder / "optimum.g2o").string());
  auto graph = std::get<PoseGraph2>(read_g2o(folder / "optimum.g2o")->graph);
  Rng rng(31);
  for (auto& node : graph.nodes) {
    const double swing = 0.1 * std::sin(0.01 * static_cast<double>(node.key));
    node.pose = Pose2(0.0, 0.0, swing) * retract(node.pose, test::random_tangent<Pose2>(rng, 0.05));
  }
  OptimizerConfig config;
  config.initialization = SolveStart::given;
  const Solution<Pose2> s = optimize(graph, config);
  EXPECT_GT(s.cost_initial, 1e3);
  EXPECT_EQ(s.status, SolveStatus::converged);
  EXPECT_NEAR(s.cost_final, 41.163269, 1e-3);
}

TEST(SolveSharedGraphs, CubicleIsRefusedAndRepairedOnRequest) {
  ADIT_NEED_DATA("g2o/single/cubicle.g2o");
  test::expect_refused("solve " + single("cubicle"), 1, "5021 of 16869 information matrices are indefinite");
  const nlohmann::json r = solved(single("cubicle") + " --repair zero-cross-blocks");
  EXPECT_NEAR(r["cost_final"].get<double>(), 2729.399, 1e-4 * 2729.399);
  EXPECT_FALSE(r["notes"].empty());
  // Rotations that are known about one axis only are beyond the certificate.
  EXPECT_EQ(r["certificate"]["status"], "cannot tell") << r["certificate"];
}

struct GraphOfAFleet {
  const char* folder;
  int num_robots;
  double cost;  // chi2, unhalved, at the optimum; no peer was measured on these
};
// The robots' files make one graph, and the given poses and chordal relaxation lead to the same optimum.
void expect_fleet_solved(const GraphOfAFleet& fleet) {
  std::vector<G2oFile> files;
  for (int robot = 0; robot < fleet.num_robots; ++robot) {
    Result<G2oFile> file =
        read_g2o(test::shared_data(std::string(fleet.folder) + "/" + std::to_string(robot) + ".g2o"));
    ASSERT_TRUE(file.has_value()) << file.error().message;
    files.push_back(std::move(*file));
  }
  const Result<G2oFile> merged = merge_g2o(files);
  ASSERT_TRUE(merged.has_value()) << merged.error().message;
  const auto& graph = std::get<PoseGraph>(merged->graph);
  EXPECT_EQ(connected_components(graph).anchors.size(), 1U);
  std::vector<Solution<Pose>> solutions;
  for (const SolveStart start : {SolveStart::given, SolveStart::chordal}) {
    OptimizerConfig config;
    config.initialization = start;
    config.relative_tolerance = 1e-10;
    solutions.push_back(optimize(graph, config));
    EXPECT_EQ(solutions.back().status, SolveStatus::converged) << solutions.back().reason;
    EXPECT_NEAR(solutions.back().cost_final, fleet.cost, 1e-6 * fleet.cost) << to_string(start);
  }
  for (std::size_t i = 0; i < graph.nodes.size(); ++i)
    EXPECT_LT(between_residual(Pose(), solutions[0].poses[i], solutions[1].poses[i]).norm(), 1e-3) << i;
}
TEST(SolveSharedGraphs, FourArgosRobotsMerge) {
  ADIT_NEED_DATA("g2o/multi/argos_clean/example_4robots/0.g2o");
  expect_fleet_solved({"g2o/multi/argos_clean/example_4robots", 4, 7361.8899});
}
TEST(SolveSharedGraphs, FourRobotsMerge) {
  ADIT_NEED_DATA("g2o/multi/example_4robots/0.g2o");
  expect_fleet_solved({"g2o/multi/example_4robots", 4, 5.5508915});
}
TEST(SolveSharedGraphs, NineRobotsMerge) {
  ADIT_NEED_DATA("g2o/multi/example_9robots/0.g2o");
  expect_fleet_solved({"g2o/multi/example_9robots", 9, 10.278053});
}

TEST(SolveSharedGraphs, TheProgramJoinsTheFilesOfAFleet) {
  ADIT_NEED_DATA("g2o/multi/example_4robots/0.g2o");
  std::string files;
  for (const char* robot : {"0", "1", "2", "3"})
    files += " " + test::shared_data(std::string("g2o/multi/example_4robots/") + robot + ".g2o").string();
  const nlohmann::json joined = solved("--join" + files);
  ASSERT_TRUE(joined.is_object()) << joined;
  EXPECT_NEAR(joined["cost_final"].get<double>(), 5.5508915, 1e-5);
  EXPECT_EQ(solved(files).size(), 4U) << "without it each file is a graph of its own";
}

constexpr const char* kUnit = " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n";  // 6x6 identity, upper triangle
std::string edge(int from, int to, const std::string& information = kUnit) {
  return "EDGE_SE3:QUAT " + std::to_string(from) + " " + std::to_string(to) + " 1 0 0 0 0 0 1" + information;
}

class SolveFile : public ::testing::Test {
 protected:
  // The argument that names a file with these bytes.
  std::string file(const std::string& bytes) {
    test::put_file(folder_ / "graph.g2o", bytes);
    return "solve " + path();
  }
  [[nodiscard]] std::string path() const { return (folder_ / "graph.g2o").string(); }
  test::TemporaryFolder folder_;
};

TEST_F(SolveFile, ChainIsSolvedAndWritten) {
  const std::string out = (folder_ / "out.g2o").string();
  test::expect_done(file("VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 5 5 5 0 0 0 1\n" + edge(0, 1)) +
                    " --out " + out);
  const auto graph = std::get<PoseGraph>(read_g2o(out)->graph);
  EXPECT_LT((graph.nodes.at(1).pose.translation() - Vector3(1, 0, 0)).norm(), 1e-9);
  EXPECT_EQ(test::num_entries(folder_.path()), 2U);
}

TEST_F(SolveFile, PlaneIsSolved) {
  test::put_file(folder_ / "graph.g2o",
                 "VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 0 0 0\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0 1\n"
                 "EDGE_SE2 0 1 3 0 0 1 0 0 1 0 1\n");
  EXPECT_NEAR(solved(path())["cost_final"].get<double>(), 2.0, 1e-9);
}

// A ring of 12 nodes that the file's poses wind twice around: each joint bent by 30 degrees, which no small
// step unbends.
TEST_F(SolveFile, WoundRingIsUnwound) {
  std::string bytes;
  const auto pose = [](double heading, double x, double y) {
    return std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(heading);
  };
  constexpr double kTurn = 2.0 * 3.14159265358979 / 12.0;
  double x = 0.0;
  double y = 0.0;
  for (int i = 0; i < 12; ++i) {
    bytes += "VERTEX_SE2 " + std::to_string(i) + " " + pose(2.0 * kTurn * i, x, y) + "\n";
    bytes += "EDGE_SE2 " + std::to_string(i) + " " + std::to_string((i + 1) % 12) + " " +
             pose(kTurn, 1.0, 0.0) + " 0.01 0 0 0.01 0 1\n";
    x += std::cos(2.0 * kTurn * i);
    y += std::sin(2.0 * kTurn * i);
  }
  test::put_file(folder_ / "graph.g2o", bytes);
  const std::string given = path() + " --set back_end.gnc.optimizer.initialization=none";
  const nlohmann::json stuck = solved(given + " --no-certificate");
  EXPECT_GT(stuck["cost_final"].get<double>(), 1.0);
  EXPECT_FALSE(stuck.contains("certificate"));
  const nlohmann::json r = solved(given);
  EXPECT_LT(r["cost_final"].get<double>(), 1e-6) << r;
  EXPECT_EQ(r["certificate"]["given"], "not optimal") << r;
  EXPECT_EQ(r["certificate"]["status"], "globally optimal") << r;
  EXPECT_NE(r["notes"].dump().find("was not optimal"), std::string::npos) << r;
}

TEST_F(SolveFile, PartsThatNoEdgeLinksAreNoted) {
  test::put_file(folder_ / "graph.g2o", edge(0, 1) + edge(10, 11));
  const nlohmann::json r = solved(path());
  EXPECT_EQ(r["status"], "converged");
  EXPECT_NE(r["notes"].dump().find("2 parts that no edge links"), std::string::npos) << r["notes"];
}

TEST_F(SolveFile, UnknownTagIsNamedWithItsLine) {
  test::expect_refused(file(edge(0, 1) + "EDGE_PROJECT_XYZ 1 2 3\n"), 1, "EDGE_PROJECT_XYZ");
  test::expect_refused(file(edge(0, 1) + "EDGE_PROJECT_XYZ 1 2 3\n"), 1, "graph.g2o: line 2");
}

TEST_F(SolveFile, FreeNodeIsNamed) {
  const std::string no_height = " 1 0 0 0 0 0 1 0 0 0 0 0 0 0 0 1 0 0 1 0 1\n";
  test::expect_refused(file(edge(0, 1) + edge(1, 2, no_height)), 1, "leave node 2 free to move");
}

TEST_F(SolveFile, NothingToReadIsAnError) {
  test::expect_refused(file(""), 1, "graph.g2o");
  test::expect_refused("solve " + (folder_ / "absent.g2o").string(), 1, "absent.g2o");
  test::expect_refused(file(edge(0, 1) + "EDGE_SE3:QUAT 1 2 1 0 nan 0 0 0 1" + kUnit), 1,
                       "graph.g2o: line 2");
}

TEST_F(SolveFile, PartsOfOneGraphAreJoined) {
  constexpr const char* kIndefinite = " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 -1 0 0 1 0 1\n";
  const std::string first = file(edge(0, 1) + edge(1, 2));
  const std::string second = (folder_ / "second.g2o").string();
  test::put_file(second, edge(1, 2) + edge(2, 3));
  const std::string out = (folder_ / "out.g2o").string();
  const test::ProgramRun run = test::run_adit(first + " " + second + " --join --out " + out);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.err.find("1 edges that several files repeat are counted once"), std::string::npos) << run.err;
  const Result<G2oFile> solved = read_g2o(out);
  ASSERT_TRUE(solved) << solved.error().message;
  EXPECT_EQ(std::get<PoseGraph>(solved->graph).nodes.size(), 4U);
  EXPECT_EQ(std::get<PoseGraph>(solved->graph).edges.size(), 3U);

  test::put_file(second, edge(2, 3) + edge(3, 4, kIndefinite));
  test::expect_refused(first + " " + second + " --join", 1, "second.g2o: line 2");
  test::expect_refused(first + " " + (folder_ / "robots.jrl").string() + " --join", 2,
                       "--join takes g2o files");
}

TEST_F(SolveFile, OneResultOnlyGoesToOneFile) {
  const std::string arguments = file(edge(0, 1));
  const test::ProgramRun run = test::run_adit(arguments + " " + path() + " --out " + path() + ".out");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("--out"), std::string::npos) << run.err;
}

TEST_F(SolveFile, FalseLoopIsRejected) {
  std::string bytes;
  for (int i = 0; i < 10; ++i) bytes += edge(i, i + 1);
  for (int i = 0; i < 8; ++i) {
    bytes += "EDGE_SE3:QUAT " + std::to_string(i) + " " + std::to_string(i + 2) + " 2 0 0 0 0 0 1" + kUnit;
  }
  test::put_file(folder_ / "graph.g2o", bytes + "EDGE_SE3:QUAT 0 10 -40 0 0 0 0 0 1" + kUnit);
  const nlohmann::json r = solved("--gnc " + path());
  EXPECT_EQ(r["loops_rejected"], 1);
  EXPECT_NEAR(r["cost_final"].get<double>(), 0.0, 1e-9);
}

/// A JSON Robot Log of two robots that drive the same square, each in a frame of its own. Of the ten loops
/// between them the last two are false.
nlohmann::json two_robots_on_a_square() {
  using Json = nlohmann::json;
  const auto key = [](int robot, int index) {
    return (static_cast<std::uint64_t>('a' + robot) << 56U) | static_cast<std::uint64_t>(index);
  };
  const auto pose = [](const Pose2& T) {
    return Json{
        {"type", "Pose2"}, {"x", T.translation().x()}, {"y", T.translation().y()}, {"theta", T.theta()}};
  };
  const auto factor = [&](std::uint64_t from, std::uint64_t to, const Pose2& T) {
    return Json{{"type", "BetweenFactorPose2"},
                {"key1", from},
                {"key2", to},
                {"measurement", pose(T)},
                {"covariance", {0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.001}}};
  };
  const Pose2 step(1.0, 0.0, std::acos(-1.0) / 20.0);
  Json file{{"name", "square"}};
  file["robots"] = Json::array({"a", "b"});
  for (int robot = 0; robot < 2; ++robot) {
    const std::string name(1, static_cast<char>('a' + robot));
    Pose2 T(0.0, 0.2 * robot, 0.0);
    for (int i = 0; i < 40; ++i, T = T * step) {
      Json truth = pose(T);
      truth["key"] = key(robot, i);
      file["groundtruth"][name].push_back(truth);
      if (i > 0)
        file["measurements"][name].push_back(
            {{"stamp", i}, {"measurements", Json::array({factor(key(robot, i - 1), key(robot, i), step)})}});
    }
    file["outlier_factors"][name] = Json::array();
    file["potential_outlier_factors"][name] = Json::array();
  }
  for (int l = 0; l < 10; ++l) {
    const Pose2 across = Pose2(0, 0, 4 * l * step.theta()).inverse() * Pose2(0.0, 0.2, 0.0) *
                         Pose2(0, 0, 4 * l * step.theta());
    const Json loop = factor(key(0, 4 * l), key(1, 4 * l), l < 8 ? across : Pose2(7.0, -5.0 * l, 1.0));
    file["potential_outlier_factors"]["b"].push_back(Json::array({file["measurements"]["b"].size(), 0}));
    if (l >= 8) file["outlier_factors"]["b"].push_back(Json::array({file["measurements"]["b"].size(), 0}));
    file["measurements"]["b"].push_back({{"stamp", 100 + l}, {"measurements", Json::array({loop})}});
  }
  return file;
}

TEST_F(SolveFile, RobotLogIsSolvedMergedAndJudged) {
  const std::string log = (folder_ / "square.jrl").string();
  test::put_file(log, two_robots_on_a_square().dump());
  const nlohmann::json r = solved("--gnc " + log)["judgement"];
  EXPECT_EQ(r["loops"]["precision"], 1.0) << r;
  EXPECT_EQ(r["loops"]["recall"], 1.0) << r;
  EXPECT_EQ(r["loops"]["false_rejected"], 2) << r;
  ASSERT_EQ(r["maps"].size(), 1U) << r;
  EXPECT_EQ(r["maps"][0]["robots"], nlohmann::json::array({"a", "b"}));
  EXPECT_LT(r["maps"][0]["error"]["ate_max_m"].get<double>(), 1e-6) << r;
  EXPECT_LT(r["robots"][1]["error"]["ate_rmse_m"].get<double>(), 1e-6) << r;
  // Without --gnc the false loops are kept: precision is 8 of 10, and the map is bent.
  const nlohmann::json kept = solved(log + " --out " + (folder_ / "out.g2o").string())["judgement"];
  EXPECT_EQ(kept["loops"]["precision"], 0.8) << kept;
  EXPECT_GT(kept["maps"][0]["error"]["ate_max_m"].get<double>(), 0.1) << kept;
  EXPECT_EQ(std::get<PoseGraph2>(read_g2o(folder_ / "out.g2o")->graph).nodes.size(), 80U);
  const test::ProgramRun run = test::run_adit("solve --gnc " + log);
  EXPECT_NE(run.out.find("one map of a, b: ATE 0.000 m RMSE"), std::string::npos) << run.out;
}

TEST_F(SolveFile, WrongRobotLogIsNamed) {
  const std::string log = (folder_ / "wrong.jrl").string();
  nlohmann::json file = two_robots_on_a_square();
  file["measurements"]["a"][3]["measurements"][0]["covariance"][0] = -1.0;
  test::put_file(log, file.dump());
  test::expect_refused("solve " + log, 1,
                       "wrong.jrl: measurements.a[3].measurements[0]: 'covariance' is not positive definite");
}

}  // namespace
}  // namespace adit

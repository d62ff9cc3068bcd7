// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Canaries: the smallest worlds in which the claims can fail. Two robots that share a drift must merge, two
/// that do not must stay apart, even where their tunnels look alike; and a graph with false loops must lose
/// those alone. Each is run as a user runs it, within seconds.
#include <gtest/gtest.h>

#include <map>
#include <numeric>
#include <sstream>

#include "adit/core/ids.hpp"
#include "adit/io/g2o.hpp"
#include "adit/io/routes_yaml.hpp"
#include "adit/io/tum.hpp"
#include "adit/posegraph/false_loops.hpp"
#include "adit/posegraph/gnc.hpp"
#include "support/files.hpp"
#include "support/laps.hpp"
#include "support/program.hpp"

namespace adit {
namespace {

using test::expect_done;
using test::get_file;

/// Waypoints, which are about a metre apart, `begin` to `end` of a route.
struct Stretch {
  std::size_t robot;
  std::ptrdiff_t begin;
  std::ptrdiff_t end;
};

/// A mine of coarse triangles, and in it the robots `a` and `b` on one stretch each.
RoutesFile put_world(const test::TemporaryFolder& folder, const std::string& arrangement, const Stretch& a,
                     const Stretch& b) {
  expect_done("world --preset mine --seed 3 --set world.facet_factor=4 --arrangement " + arrangement +
              " --out " + (folder / "world").string());
  const Result<RoutesFile> whole = read_routes(folder / "world/routes.yaml");
  EXPECT_TRUE(whole) << whole.error().message;
  if (!whole) return {};
  RoutesFile pair{"world/world.ply", {}};
  for (const auto& [name, stretch] : {std::pair{"a", a}, std::pair{"b", b}}) {
    const Route& route = whole->routes.at(stretch.robot);
    pair.routes.push_back({name, route.speed_mps,
                           std::vector<Vector3>(route.waypoints.begin() + stretch.begin,
                                                route.waypoints.begin() + stretch.end)});
  }
  EXPECT_TRUE(write_routes(folder / "pair.yaml", pair));
  return pair;
}

std::string map_pair(const test::TemporaryFolder& folder) {
  const test::ProgramRun run = test::run_adit("slam " + (folder / "pair.yaml").string() +
                                              " --lidar os2-32 --out " + (folder / "session").string());
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return get_file(folder / "session/session.toml");
}

/// The rows of loops.csv, by the names of its columns.
std::vector<std::map<std::string, std::string>> loops_of(const std::filesystem::path& session) {
  std::istringstream lines(get_file(session / "loops.csv"));
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    std::vector<std::string>& row = rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
  }
  std::vector<std::map<std::string, std::string>> loops;
  for (std::size_t i = 1; i < rows.size(); ++i)
    for (std::size_t c = 0; c < std::min(rows[0].size(), rows[i].size()); ++c) {
      if (c == 0) loops.emplace_back();
      loops.back()[rows[0][c]] = rows[i][c];
    }
  return loops;
}

/// Loops that passed the registration, the choice of consistent ones and the optimizer.
std::ptrdiff_t num_in_use(const std::filesystem::path& session) {
  return std::ranges::count_if(loops_of(session), [](const auto& loop) {
    return loop.at("verdict") == "accepted" && loop.at("pcm") == "kept" && loop.at("gnc_weight") == "1.0000";
  });
}

/// Positions of the first and the last keyframe of both robots, in the frame of the session.
std::vector<Vector3> ends_of(const std::filesystem::path& session) {
  std::vector<Vector3> ends;
  for (const char* robot : {"a", "b"}) {
    const Result<Trajectory> poses = read_tum(session / robot / "trajectory.tum");
    EXPECT_TRUE(poses) << poses.error().message;
    if (!poses) return {};
    ends.push_back(poses->front().T_world_body.translation());
    ends.push_back(poses->back().T_world_body.translation());
  }
  return ends;
}

TEST(Canaries, TwoRobotsOnOneDriftMergeWhereTheyAre) {
  const test::TemporaryFolder folder;
  const RoutesFile pair = put_world(folder, "single", {0, 0, 46}, {0, 8, 54});
  ASSERT_EQ(pair.routes.size(), 2U);
  const std::string session = map_pair(folder);
  EXPECT_NE(session.find("merged = true"), std::string::npos) << session;
  EXPECT_GE(num_in_use(folder / "session"), 15);

  // Distances within and between the robots are those of the routes, to 1 % of what they drove: the last
  // keyframe may stand half a metre before the end.
  const std::vector<Vector3> truth = {pair.routes[0].waypoints.front(), pair.routes[0].waypoints.back(),
                                      pair.routes[1].waypoints.front(), pair.routes[1].waypoints.back()};
  const std::vector<Vector3> ends = ends_of(folder / "session");
  ASSERT_EQ(ends.size(), truth.size());
  for (std::size_t i = 0; i < ends.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      EXPECT_NEAR((ends[i] - ends[j]).norm(), (truth[i] - truth[j]).norm(), 0.45) << i << " and " << j;
}

TEST(Canaries, TwoRobotsInDriftsThatLookAlikeStayApart) {
  const test::TemporaryFolder folder;
  // The second network is the mirror image of the first: no place is shared, many look the same.
  put_world(folder, "mirrored", {0, 0, 40}, {2, 0, 40});
  const std::string session = map_pair(folder);
  EXPECT_EQ(session.find("merged = true"), std::string::npos) << session;
  EXPECT_NE(session.find("merged = false"), std::string::npos) << session;
  EXPECT_EQ(num_in_use(folder / "session"), 0);
  EXPECT_FALSE(loops_of(folder / "session").empty()) << "nothing looked alike: this canary tests nothing";
}

TEST(Canaries, TwoRobotsFarApartInOneMineStayApart) {
  const test::TemporaryFolder folder;
  put_world(folder, "single", {0, 0, 40}, {1, 300, 340});
  const std::string session = map_pair(folder);
  EXPECT_NE(session.find("merged = false"), std::string::npos) << session;
  EXPECT_EQ(num_in_use(folder / "session"), 0);
}

/// Half of the loops are false, in runs that agree with each other, as look-alike tunnels produce them.
TEST(Canaries, OfFalseLoopsNoneIsKeptAndNoTrueOneIsLost) {
  const PoseGraph laps = test::two_laps(0);
  const LabelledGraph<Pose> spoiled = with_false_loops(laps, 0.5, FalseLoops::clustered, 7);
  ASSERT_EQ(spoiled.num_true, laps.edges.size());
  const std::size_t num_false = spoiled.graph.edges.size() - spoiled.num_true;
  ASSERT_EQ(num_false, test::kLapNodes);

  const Solution<Pose> solution = optimize_gnc(spoiled.graph);
  ASSERT_TRUE(solution.ok()) << solution.reason;
  const auto first_false = solution.edge_weights.begin() + static_cast<std::ptrdiff_t>(spoiled.num_true);
  const auto first_loop = first_false - static_cast<std::ptrdiff_t>(test::kLapNodes);
  const auto kept = [](double weight) { return weight > 0.5; };
  EXPECT_EQ(std::count_if(first_loop, first_false, kept), test::kLapNodes) << "recall below 1";
  EXPECT_EQ(std::count_if(first_false, solution.edge_weights.end(), kept), 0) << "precision below 1";

  const test::TemporaryFolder folder;
  {
    std::ofstream file(folder / "spoiled.g2o");
    write_g2o(file, spoiled.graph);
  }
  const test::ProgramRun run = test::run_adit("solve " + (folder / "spoiled.g2o").string() + " --gnc --json");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("\"loops_rejected\": " + std::to_string(num_false)), std::string::npos) << run.out;
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/incremental_study.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "adit/io/g2o.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

/// Four laps of a ring of 30 nodes, with a loop to the lap before at every second node.
std::string laps() {
  PoseGraph2 graph;
  const Pose2 step(1.0, 0.0, 2.0 * std::acos(-1.0) / 30.0);
  const Matrix3 information = Eigen::Vector3d(1e3, 1e3, 1e4).asDiagonal();
  for (std::size_t i = 0; i < 120; ++i) {
    graph.nodes.push_back({i, i == 0 ? Pose2() : graph.nodes.back().pose * step});
    if (i > 0) graph.edges.push_back({i - 1, i, step, information, EdgeKind::odometry});
    if (i >= 30 && i % 2 == 0) graph.edges.push_back({i - 30, i, Pose2(), information, EdgeKind::loop});
  }
  std::ostringstream out;
  write_g2o(out, graph);
  return out.str();
}

TEST(IncrementalStudy, JudgesEveryStep) {
  const test::TemporaryFolder folder;
  test::put_file(folder / "laps.g2o", laps());
  ListedGraph listed;
  listed.name = "laps";
  listed.path = (folder / "laps.g2o").string();
  const auto runs = run_incremental(listed, {}, {0, 30});
  ASSERT_TRUE(runs) << runs.error().message;
  ASSERT_EQ(runs->size(), 2U);
  const IncrementalRun& clean = runs->front();
  EXPECT_EQ(clean.num_nodes, 120U);
  EXPECT_EQ(clean.num_true, 45U);
  EXPECT_EQ(clean.num_false, 0U);
  EXPECT_EQ(clean.precision.mean, 1.0);
  EXPECT_LT(clean.ate_m.worst, 1e-6);
  const IncrementalRun& spoiled = runs->back();
  EXPECT_GT(spoiled.num_false, 10U);
  EXPECT_EQ(spoiled.precision.worst, 1.0);
  EXPECT_GT(spoiled.recall.last, 0.9);
  EXPECT_LE(spoiled.median_ms, spoiled.p99_ms);
  EXPECT_NE(summary_line(spoiled).find("laps"), std::string::npos);
  EXPECT_NE(json_of(*runs).find("\"share_pct\": 30"), std::string::npos);
}

TEST(IncrementalStudy, NamesAFileThatIsAbsent) {
  ListedGraph listed;
  listed.path = "/nowhere/absent.g2o";
  const auto runs = run_incremental(listed, {}, {10});
  ASSERT_FALSE(runs);
  EXPECT_NE(runs.error().message.find("absent.g2o"), std::string::npos);
}

TEST(IncrementalStudy, RefusesAGraphWithoutASingleStep) {
  const test::TemporaryFolder folder;
  test::put_file(folder / "alone.g2o", "VERTEX_SE2 0 0 0 0\n");
  ListedGraph listed;
  listed.path = (folder / "alone.g2o").string();
  EXPECT_ERROR(run_incremental(listed, {}, {10}), "alone.g2o: a graph of fewer than two nodes");
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/graph_judgement.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

/// Three robots of ten nodes on parallel lines. Loops between the first two: four true, two false.
JrlGraph<Pose2> three_robots() {
  JrlGraph<Pose2> jrl;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t i = 0; i < 10; ++i) {
      const Pose2 pose(static_cast<double>(i),
                       10.0 * static_cast<double>(r) + 0.1 * static_cast<double>(i * i), 0.0);
      jrl.graph.nodes.push_back({100 * r + i, pose});
      jrl.robot_of_node.push_back(r);
      jrl.truth.emplace_back(pose);
      if (i > 0)
        jrl.graph.edges.push_back(
            {10 * r + i - 1, 10 * r + i, Pose2(), Matrix3::Identity(), EdgeKind::odometry});
    }
  }
  jrl.labels.assign(jrl.graph.edges.size(), JrlLabel::inlier);
  for (std::size_t i = 0; i < 6; ++i) {
    jrl.graph.edges.push_back({i, 10 + i, Pose2(), Matrix3::Identity(), EdgeKind::loop});
    jrl.labels.push_back(i < 4 ? JrlLabel::inlier : JrlLabel::outlier);
  }
  return jrl;
}

Solution<Pose2> solution_of(const JrlGraph<Pose2>& jrl) {
  Solution<Pose2> s;
  s.poses = poses_of(jrl.graph);
  s.edge_weights.assign(jrl.graph.edges.size(), 1.0);
  return s;
}

TEST(GraphJudgement, CountsWhatIsKeptAgainstTheLabels) {
  const JrlGraph<Pose2> jrl = three_robots();
  Solution<Pose2> s = solution_of(jrl);
  const std::size_t first = jrl.graph.edges.size() - 6;
  s.edge_weights[first] = 0.0;      // one true loop lost
  s.edge_weights[first + 5] = 0.0;  // one false loop rejected
  const GraphJudgement judgement = judged(jrl, {"a", "b", "c"}, s);
  ASSERT_TRUE(judgement.loops);
  EXPECT_DOUBLE_EQ(judgement.loops->precision().value(), 3.0 / 4.0);
  EXPECT_DOUBLE_EQ(judgement.loops->recall().value(), 3.0 / 4.0);
  EXPECT_EQ(sentences(judgement).front(),
            "loops by their labels: precision 75.0 %, recall 75.0 % (3 of 4 true kept, 1 of 2 false kept)");
}

TEST(GraphJudgement, AlignsEachRobotAndEachMap) {
  const JrlGraph<Pose2> jrl = three_robots();
  Solution<Pose2> s = solution_of(jrl);
  // Everything turned, robot b also 2 m away from where it belongs.
  for (std::size_t i = 0; i < s.poses.size(); ++i) {
    const Pose2 shift(0.0, jrl.robot_of_node[i] == 1 ? 2.0 : 0.0, 0.0);
    s.poses[i] = Pose2(3.0, 4.0, 1.0) * shift * s.poses[i];
  }
  const GraphJudgement judgement = judged(jrl, {"a", "b", "c"}, s);
  for (const auto& robot : judgement.robots) EXPECT_LT(robot.error.value().max_m, 1e-9) << robot.name;
  ASSERT_EQ(judgement.maps.size(), 2U);
  EXPECT_EQ(judgement.maps[0].robots, (std::vector<std::string>{"a", "b"}));
  EXPECT_GT(judgement.maps[0].error.value().rmse_m, 0.1);
  EXPECT_LT(judgement.maps[0].error.value().rmse_m, 1.0 + 1e-9);
  EXPECT_EQ(judgement.maps[1].robots, (std::vector<std::string>{"c"}));
}

TEST(GraphJudgement, RejectedLoopsJoinNoMapsButPriorsDo) {
  JrlGraph<Pose2> jrl = three_robots();
  Solution<Pose2> s = solution_of(jrl);
  for (std::size_t e = jrl.graph.edges.size() - 6; e < jrl.graph.edges.size(); ++e) s.edge_weights[e] = 0.0;
  EXPECT_EQ(judged(jrl, {"a", "b", "c"}, s).maps.size(), 3U);
  for (const std::size_t node : {std::size_t{0}, std::size_t{20}})
    jrl.priors.push_back({node, Pose2(), Matrix3::Identity()});
  const auto maps = judged(jrl, {"a", "b", "c"}, s).maps;
  ASSERT_EQ(maps.size(), 2U);
  EXPECT_EQ(maps[0].robots, (std::vector<std::string>{"a", "c"}));
}

TEST(GraphJudgement, SaysWhatItCannotJudge) {
  JrlGraph<Pose2> jrl = three_robots();
  for (auto& label : jrl.labels) label = JrlLabel::unlabelled;
  for (auto& truth : jrl.truth) truth.reset();
  const GraphJudgement judgement = judged(jrl, {"a", "b", "c"}, solution_of(jrl));
  EXPECT_FALSE(judgement.loops);
  EXPECT_FALSE(judgement.robots[0].error);
  EXPECT_EQ(sentences(judgement).front(), "robot a: 10 poses, no ground truth to compare with");
}

}  // namespace
}  // namespace adit

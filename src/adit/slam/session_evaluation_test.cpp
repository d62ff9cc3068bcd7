// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/session_evaluation.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "adit/io/loops_csv.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

constexpr int kNumPoses = 30;

Stamp second(int s) { return Stamp{1'000'000'000LL * s}; }

/// One pose per second and metre along y = `lane`, the estimates off by `bend` metres at the end.
Trajectory straight(double lane, double bend = 0.0, int first_second = 1) {
  Trajectory path;
  for (int k = 0; k < kNumPoses; ++k)
    path.push_back({second(first_second + k), Pose::translation_of(k, lane + bend * k / (kNumPoses - 1), 0)});
  return path;
}

SavedLoop loop(int from, int to, const Pose& T_from_to, double weight) {
  SavedLoop saved;
  saved.from_robot = "ada";
  saved.to_robot = "bo";
  saved.from_stamp = second(1 + from);
  saved.to_stamp = second(1 + to);
  saved.loop.T_from_to = T_from_to;
  saved.loop.verdict = LoopVerdict::accepted;
  saved.in_clique = weight > 0.0;
  saved.weight = weight;
  return saved;
}

/// Two robots beside one another in one map; a correct loop, a wrong registration, a wrong place, a refused
/// one.
SavedSession two_robots() {
  SavedSession session;
  session.robots = {"ada", "bo"};
  session.components = {{"ada", "bo"}};
  session.optimized = {straight(0.0), straight(2.0, 0.4)};
  session.odometry = {straight(0.0), straight(2.0)};
  const Pose beside = Pose::translation_of(0, 2, 0);
  session.loops = {loop(3, 3, beside, 1.0), loop(4, 4, Pose::translation_of(3, 2, 0), 1.0),
                   loop(0, 20, beside, 0.0), loop(5, 5, beside, 0.0)};
  session.loops.back().loop.verdict = LoopVerdict::rejected;
  return session;
}

TEST(MatchTruths, ByNameInAnyOrder) {
  const SavedSession session = two_robots();
  for (const auto& [a, b] : {std::pair("x/ada_truth.tum", "x/bo_truth.tum"), std::pair("ada.tum", "bo.tum"),
                             std::pair("robots/ada/truth.tum", "robots/bo/truth.tum"),
                             std::pair("ada-gt.tum", "bo.groundtruth.tum")}) {
    const auto truths = match_truths(session, {{b, "", straight(2.0)}, {a, "", straight(0.0)}});
    ASSERT_TRUE(truths.has_value()) << truths.error().message;
    EXPECT_EQ((*truths)[0]->front().T_world_body.translation().y(), 0.0) << a;
    EXPECT_EQ((*truths)[1]->front().T_world_body.translation().y(), 2.0) << b;
  }
  const auto named = match_truths(session, {{"1.tum", "bo", straight(2.0)}});
  ASSERT_TRUE(named.has_value()) << named.error().message;
  EXPECT_FALSE((*named)[0].has_value());
  EXPECT_TRUE((*named)[1].has_value());
}

TEST(MatchTruths, WhatCannotBelongIsRefused) {
  const SavedSession session = two_robots();
  EXPECT_ERROR(match_truths(session, {{"x/cy_truth.tum", "", straight(0.0)}}),
               "x/cy_truth.tum: it names none of the robots ada, bo; give it as NAME=x/cy_truth.tum");
  EXPECT_ERROR(match_truths(session, {{"1.tum", "cy", straight(0.0)}}),
               "'cy' is not one of the robots ada, bo");
  EXPECT_ERROR(match_truths(session, {{"ada.tum", "", straight(0.0)}, {"ada_gt.tum", "", straight(0.0)}}),
               "ada.tum and ada_gt.tum are both the truth of ada");
  EXPECT_ERROR(match_truths(session, {{"ada.tum", "", straight(0.0, 0.0, 1000)}}),
               "it is not the truth of this drive");
}

TEST(SessionEvaluation, NumbersByHand) {
  const SavedSession session = two_robots();
  const Result<SessionEvaluation> evaluation = evaluate(session, {straight(0.0), straight(2.0)});
  ASSERT_TRUE(evaluation.has_value()) << evaluation.error().message;
  EXPECT_EQ(evaluation->loop_classes,
            (std::vector<std::string>{"correct", "wrong_registration", "wrong_place", ""}));
  EXPECT_EQ(evaluation->registered, (LoopCounts{3, 1, 1}));
  EXPECT_EQ(evaluation->consistent, (LoopCounts{2, 0, 1}));
  EXPECT_EQ(evaluation->in_use, (LoopCounts{2, 0, 1}));
  EXPECT_EQ(evaluation->num_unjudged, 0);
  // One alignment for both spreads the bend of one over them; the odometry is right.
  EXPECT_GT(evaluation->robots[0].joint->max_m, 0.05);
  EXPECT_LT(evaluation->robots[1].joint->max_m, 0.4);
  EXPECT_NEAR(evaluation->robots[0].odometry->max_m, 0.0, 1e-9);
  EXPECT_NEAR(evaluation->robots[0].relative->translation_median_m, 0.0, 1e-9);
  EXPECT_NEAR(evaluation->robots[1].relative->translation_median_m, 0.4 * 10 / (kNumPoses - 1), 1e-6);
}

TEST(SessionEvaluation, ARobotWithoutTruthIsLeftOut) {
  const SavedSession session = two_robots();
  const Result<SessionEvaluation> evaluation = evaluate(session, {straight(0.0), std::nullopt});
  ASSERT_TRUE(evaluation.has_value()) << evaluation.error().message;
  EXPECT_NEAR(evaluation->robots[0].joint->max_m, 0.0, 1e-9);
  EXPECT_FALSE(evaluation->robots[1].joint.has_value());
  EXPECT_EQ(evaluation->num_unjudged, 3);
  EXPECT_EQ(evaluation->registered.total, 0);
  const auto json = nlohmann::json::parse(json_of(*evaluation));
  EXPECT_TRUE(json["robots"][1]["ate_max_m"].is_null());
  EXPECT_NEAR(json["robots"][0]["rpe_translation_median_m"].get<double>(), 0.0, 1e-9);
}

/// A loops.csv of two rows and the columns of earlier versions.
std::string small_csv() {
  return "from_robot,from_keyframe,from_stamp,to_robot,to_keyframe,to_stamp,place_distance,inliers,overlap,"
         "weak_axis,verdict,pcm,gnc_weight,class,x,y,z,qx,qy,qz,qw,reason\n"
         "ada,1,2.0,bo,1,2.0,0.1,70,0.9,0.1,accepted,kept,1.0000,,0,2,0,0,0,0,1,in use\n"
         "ada,2,3.0,bo,2,3.0,0.1,3,0.1,0.1,rejected,,,,0,2,0,0,0,0,1,few inliers\n";
}

TEST(SessionEvaluation, TheSessionKeepsItsClassesAndErrors) {
  const test::TemporaryFolder folder;
  test::put_file(folder / "loops.csv", small_csv());
  test::put_file(folder / "metrics.json", "{\"version\": 1, \"robots\": [\"as it was\"]}");
  SessionEvaluation evaluation;
  evaluation.robots = {{"ada", {}, {}, {}}};
  evaluation.loop_classes = {"wrong_place", ""};
  for (int time = 0; time < 2; ++time)
    ASSERT_TRUE(save_evaluation(folder.path(), evaluation).has_value()) << "again: the same";
  const std::string csv = test::get_file(folder / "loops.csv");
  EXPECT_NE(csv.find(",1.0000,wrong_place,0,2,"), std::string::npos) << csv;
  EXPECT_EQ(parse_loops_csv(csv)->size(), 2U);
  const auto metrics = nlohmann::json::parse(test::get_file(folder / "metrics.json"));
  EXPECT_EQ(metrics["robots"][0], "as it was");
  EXPECT_EQ(metrics["evaluation"]["robots"][0]["name"], "ada");

  evaluation.loop_classes = {"correct"};
  EXPECT_ERROR(save_evaluation(folder.path(), evaluation), "2 loops, and 1 classes were given");
}

}  // namespace
}  // namespace adit

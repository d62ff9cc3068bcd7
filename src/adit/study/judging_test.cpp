// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/judging.hpp"

#include <gtest/gtest.h>

#include "support/files.hpp"

namespace adit {
namespace {

constexpr std::uint32_t kNumKeyframes = 20;
constexpr std::size_t kAda = 0;
constexpr std::size_t kBo = 1;
constexpr std::size_t kCy = 2;

Stamp second(std::uint32_t k) { return Stamp{1'000'000'000LL * k}; }

/// A bend, a metre of x per keyframe; robots side by side, 2 m of y apart.
Pose true_pose(std::size_t robot, std::uint32_t k) {
  return Pose::translation_of(k, 2.0 * static_cast<double>(robot) + 0.05 * k * k, 0.0);
}

/// Its odometry is exact and starts at the identity.
RobotRun robot_run(std::size_t robot, const std::string& name) {
  RobotMap map;
  map.id = {static_cast<std::uint8_t>(robot)};
  map.name = name;
  RobotRun run;
  for (std::uint32_t k = 0; k < kNumKeyframes; ++k) {
    map.keyframes.push_back(
        {{map.id, k}, second(k), true_pose(robot, 0).inverse() * true_pose(robot, k), nullptr});
    run.truth.push_back({second(k), true_pose(robot, k)});
  }
  run.map = run.paper_map = std::make_shared<const RobotMap>(std::move(map));
  run.result.name = name;
  run.result.path_length_m = path_length(run.truth);
  return run;
}

LoopOutcome loop(KeyframeId from, KeyframeId to, const Vector3& error, double weight) {
  LoopOutcome outcome;
  outcome.loop.from = from;
  outcome.loop.to = to;
  outcome.loop.T_from_to = true_pose(from.robot.value, from.index).inverse() *
                           true_pose(to.robot.value, to.index) *
                           Pose::translation_of(error.x(), error.y(), error.z());
  outcome.is_selected = weight > 0.0;
  outcome.weight = weight;
  return outcome;
}

/// Not merged where there is a reason.
PairOutcome pair_of(std::uint8_t a, std::uint8_t b, const std::string& refused_reason = "") {
  PairOutcome outcome;
  outcome.a = {a};
  outcome.b = {b};
  outcome.merged = refused_reason.empty();
  outcome.refused_reason = refused_reason;
  return outcome;
}

Component component_of(const std::vector<RobotId>& robots) {
  Component component;
  component.anchor = robots.front();
  component.robots = robots;
  return component;
}

/// Ada, Bo and Cy, and a solution that puts all of them where they were, `T_shift` apart from the truth.
struct Fleet {
  std::vector<RobotRun> runs = {robot_run(kAda, "ada"), robot_run(kBo, "bo"), robot_run(kCy, "cy")};
  FleetSolution solution;

  Fleet() {
    for (std::size_t robot = 0; robot < runs.size(); ++robot) put(robot, Pose());
  }
  /// Moves all keyframes of a robot by `T_shift` of the solution's frame, which is Ada's odometry.
  void put(std::size_t robot, const Pose& T_shift) {
    std::vector<Pose>& poses = solution.T_world_keyframe[runs[robot].map->id];
    poses.clear();
    for (std::uint32_t k = 0; k < kNumKeyframes; ++k)
      poses.push_back(T_shift * true_pose(kAda, 0).inverse() * true_pose(robot, k));
  }
  [[nodiscard]] std::vector<const RobotRun*> only(const std::vector<std::size_t>& robots) const {
    std::vector<const RobotRun*> some;
    for (const std::size_t robot : robots) some.push_back(&runs[robot]);
    return some;
  }
  static Meeting meeting_of(const std::vector<const RobotRun*>& runs) {
    Meeting meeting;
    for (const RobotRun* run : runs) meeting.maps.push_back(run->map);
    return meeting;
  }
};

/// Ada and Bo merged by a correct loop, while a wrong registration is switched off and a wrong place is not.
Fleet merged_pair() {
  Fleet fleet;
  FleetSolution& solution = fleet.solution;
  solution.loops = {loop({{0}, 5}, {{1}, 5}, {0, 0, 0}, 1.0), loop({{0}, 6}, {{1}, 6}, {2, 0, 0}, 0.2),
                    loop({{0}, 0}, {{1}, 15}, {0, 0, 0}, 0.5), loop({{0}, 1}, {{1}, 16}, {0, 0, 0}, 0.0)};
  solution.pairs = {pair_of(0, 1)};
  solution.components = {component_of({{0}, {1}})};
  return fleet;
}

PairResult result_of(const Fleet& fleet, const std::vector<std::size_t>& robots) {
  const std::vector<const RobotRun*> runs = fleet.only(robots);
  const Meeting meeting = Fleet::meeting_of(runs);
  const Result<JudgedSolution> judged = judge(runs, meeting, fleet.solution);
  EXPECT_TRUE(judged) << judged.error().message;
  return pair_result(runs, meeting, *judged);
}

TEST(Judge, EachLoopHasTheClassThatTheTruthGivesIt) {
  const Fleet fleet = merged_pair();
  const std::vector<const RobotRun*> runs = fleet.only({kAda, kBo});
  const Result<JudgedSolution> judged = judge(runs, Fleet::meeting_of(runs), fleet.solution);
  ASSERT_TRUE(judged) << judged.error().message;
  EXPECT_EQ(judged->loop_classes, (std::vector{LoopClass::correct, LoopClass::wrong_registration,
                                               LoopClass::wrong_place, LoopClass::wrong_place}));
}

TEST(Judge, RobotsMayComeInAnyOrder) {
  const Fleet fleet = merged_pair();
  const std::vector<const RobotRun*> runs = fleet.only({kBo, kCy, kAda});
  const Result<JudgedSolution> judged = judge(runs, Fleet::meeting_of(runs), fleet.solution);
  ASSERT_TRUE(judged) << judged.error().message;
  EXPECT_EQ(judged->loop_classes[0], LoopClass::correct);
  EXPECT_EQ(judged->loop_classes[1], LoopClass::wrong_registration);
}

TEST(Judge, ALoopWithAStrangerIsRefused) {
  const Fleet fleet = merged_pair();
  const std::vector<const RobotRun*> runs = fleet.only({kAda, kCy});
  EXPECT_ERROR(judge(runs, Fleet::meeting_of(runs), fleet.solution), "a robot that took no part");
}

TEST(Judge, ATruthThatEndsEarlyIsRefusedByTheRobotsName) {
  Fleet fleet = merged_pair();
  fleet.runs[kBo].truth.resize(10);  // its keyframe 15 has a loop
  const std::vector<const RobotRun*> runs = fleet.only({kAda, kBo});
  EXPECT_ERROR(judge(runs, Fleet::meeting_of(runs), fleet.solution), "bo: ");
}

TEST(PairResult, CountsLoopsBeforeAndAfterSelectionAndTheWrongOnesInUse) {
  const PairResult pair = result_of(merged_pair(), {kAda, kBo});
  EXPECT_TRUE(pair.merged);
  EXPECT_EQ(pair.refused_reason, "");
  EXPECT_EQ(pair.loops_before_pcm, (LoopCounts{4, 2, 1}));
  EXPECT_EQ(pair.loops_after_pcm, (LoopCounts{3, 1, 1}));
  EXPECT_EQ(pair.wrong_loops_in_solution, 1) << "the wrong place at a weight of exactly one half";
}

TEST(PairResult, APerfectMergeHasNoErrorInOneFrameForBoth) {
  const PairResult pair = result_of(merged_pair(), {kAda, kBo});
  for (const MergedRobot& robot : pair.robots) {
    ASSERT_TRUE(robot.ate.has_value()) << robot.name;
    EXPECT_LT(robot.ate->max_m, 1e-9) << robot.name;
    EXPECT_GT(robot.path_length_m, 19.0) << robot.name;
  }
  EXPECT_TRUE(pair.success());
}

TEST(PairResult, AMergeInTheWrongPlaceShowsInTheErrorOfBoth) {
  Fleet fleet = merged_pair();
  fleet.put(kBo, Pose::translation_of(0, 0, 8));
  const PairResult pair = result_of(fleet, {kAda, kBo});
  EXPECT_TRUE(pair.merged);
  EXPECT_FALSE(pair.success());
  // One alignment cannot lift one robot and not the other: it spreads or tilts, and metres remain.
  EXPECT_GT(pair.robots[0].ate->max_m, 1.0);
  EXPECT_GT(pair.robots[1].ate->max_m, 1.0);
}

TEST(PairResult, RobotsThatWereNotMergedAreAlignedEachByItself) {
  Fleet fleet = merged_pair();
  fleet.put(kBo, Pose::planar(50, -30, 1.0));
  fleet.solution.pairs = {pair_of(0, 1, "one loop; drive on")};
  fleet.solution.components = {component_of({{0}}), component_of({{1}})};
  const PairResult pair = result_of(fleet, {kAda, kBo});
  EXPECT_FALSE(pair.merged);
  EXPECT_EQ(pair.refused_reason, "one loop; drive on");
  EXPECT_FALSE(pair.success()) << "exact, but not merged";
  for (const MergedRobot& robot : pair.robots) EXPECT_LT(robot.ate->max_m, 1e-6) << robot.name;
}

TEST(PairResult, PicturesHoldTheLoopsOfTheirStageAtTheTruePlaces) {
  const PairResult pair = result_of(merged_pair(), {kAda, kBo});
  EXPECT_EQ(pair.initial.loops.size(), 4U);
  EXPECT_EQ(pair.after_pcm.loops.size(), 3U);
  ASSERT_EQ(pair.optimized.loops.size(), 2U);
  EXPECT_EQ(pair.optimized.loops[0].loop_class, LoopClass::correct);
  EXPECT_EQ(pair.optimized.loops[1].loop_class, LoopClass::wrong_place);
  for (const GraphPicture* picture : {&pair.initial, &pair.after_pcm, &pair.optimized}) {
    EXPECT_LT((picture->loops[0].a - true_pose(kAda, 5).translation()).norm(), 1e-6);
    EXPECT_LT((picture->loops[0].b - true_pose(kBo, 5).translation()).norm(), 1e-6);
    ASSERT_EQ(picture->robot_paths.size(), 2U);
    EXPECT_EQ(picture->robot_paths[0].size(), kNumKeyframes);
  }
}

TEST(PairResult, ExchangedRobotsExchangeNamesAndPathsButNotTheEndsOfLoops) {
  const PairResult pair = result_of(merged_pair(), {kBo, kAda});
  EXPECT_EQ(pair.robots[0].name, "bo");
  EXPECT_EQ(pair.robots[1].name, "ada");
  EXPECT_LT((pair.initial.robot_paths[0][7] - true_pose(kBo, 7).translation()).norm(), 1e-6);
  EXPECT_LT((pair.optimized.robot_paths[1][7] - true_pose(kAda, 7).translation()).norm(), 1e-6);
  EXPECT_LT((pair.optimized.loops[0].a - true_pose(kAda, 5).translation()).norm(), 1e-6);
}

TEST(PairResult, WithoutTruthPicturesAreDrawnWhereTheSolutionHasThem) {
  Fleet fleet = merged_pair();
  fleet.solution.loops.clear();
  fleet.runs[kBo].truth.clear();
  const PairResult pair = result_of(fleet, {kAda, kBo});
  EXPECT_FALSE(pair.robots[1].ate.has_value());
  EXPECT_FALSE(pair.success());
  ASSERT_EQ(pair.optimized.robot_paths[1].size(), kNumKeyframes);
  EXPECT_LT((pair.optimized.robot_paths[1][7] - Vector3(7.0, 2.0 + 0.05 * 49, 0.0)).norm(), 1e-9);
}

TEST(JointResult, SaysWhoSharesAMapAndWhyOthersDoNot) {
  Fleet fleet = merged_pair();
  fleet.put(kCy, Pose::planar(-7, 3, 2.0));  // a map of its own
  FleetSolution& solution = fleet.solution;
  solution.pairs = {pair_of(0, 1), pair_of(0, 2, "no place of one resembled the other"),
                    pair_of(1, 2, "a single loop")};
  solution.components.push_back(component_of({{2}}));
  const std::vector<const RobotRun*> runs = fleet.only({kAda, kBo, kCy});
  Meeting meeting = Fleet::meeting_of(runs);
  meeting.bytes_sent = {10, 20, 30};
  const Result<JudgedSolution> judged = judge(runs, meeting, solution);
  ASSERT_TRUE(judged) << judged.error().message;
  const JointResult joint = joint_result(runs, meeting, *judged);
  EXPECT_EQ(joint.components, (std::vector<std::vector<std::string>>{{"ada", "bo"}, {"cy"}}));
  EXPECT_EQ(joint.refusals, (std::vector<std::string>{"ada and cy: no place of one resembled the other",
                                                      "bo and cy: a single loop"}));
  EXPECT_EQ(joint.bytes_sent_per_robot, meeting.bytes_sent);
  EXPECT_EQ(joint.loops, (LoopCounts{3, 1, 1})) << "those that were selected";
  EXPECT_EQ(joint.wrong_loops_in_solution, 1);
  ASSERT_EQ(joint.robots.size(), 3U);
  for (const MergedRobot& robot : joint.robots) EXPECT_LT(robot.ate->max_m, 1e-6) << robot.name;
}

}  // namespace
}  // namespace adit

// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/distinctive_places.hpp"

#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/tube_drive.hpp"

namespace adit {
namespace {

const std::vector<test::Box> kBlocks = {{{11.0, 1.5, -2.0}, {13.0, 4.0, 1.0}},
                                        {{24.0, -4.0, -2.0}, {25.0, -1.8, 0.0}},
                                        {{38.0, 2.0, -2.0}, {42.0, 4.5, 2.0}},
                                        {{52.0, -4.0, -1.0}, {52.8, -1.5, 2.0}}};

/// A robot that drove along this tube; according to its truth the tube begins at `begin` in the world.
RobotRun run_in_a_tube(std::uint8_t robot, const std::vector<test::Box>& boxes,
                       const Vector3& begin = Vector3::Zero()) {
  RobotRun run;
  run.map = test::in_a_tube(boxes, {robot});
  run.result.name = run.map->name;
  const Pose T_world_tube = Pose::translation_of(begin.x(), begin.y(), begin.z());
  for (const Keyframe& keyframe : run.map->keyframes)
    run.truth.push_back({keyframe.stamp, T_world_tube * keyframe.T_odom_base});
  return run;
}

const Vector3 kFarAway(0.0, 500.0, 0.0);

TEST(DistinctivePlaces, AreCountedWhereTwoRobotsSawThem) {
  const auto places = distinctive_places({run_in_a_tube(0, kBlocks), run_in_a_tube(1, kBlocks)}, {});
  ASSERT_TRUE(places) << places.error().message;
  EXPECT_EQ((*places)[0][0], 0);
  EXPECT_EQ((*places)[0][1], (*places)[1][0]);
  EXPECT_GE((*places)[0][1], 3);  // of the six that are sampled
}

TEST(DistinctivePlaces, ASmoothTubeHasNone) {
  const auto places = distinctive_places({run_in_a_tube(0, {}), run_in_a_tube(1, {})}, {});
  ASSERT_TRUE(places) << places.error().message;
  EXPECT_EQ((*places)[0][1], 0);
}

TEST(DistinctivePlaces, APlaceWithATwinElsewhereIsNone) {
  const auto places = distinctive_places(
      {run_in_a_tube(0, kBlocks), run_in_a_tube(1, kBlocks), run_in_a_tube(2, kBlocks, kFarAway)}, {});
  ASSERT_TRUE(places) << places.error().message;
  EXPECT_EQ((*places)[0][1], 0);
}

TEST(DistinctivePlaces, RobotsThatDroveApartShareNone) {
  const std::vector<test::Box> others = {{{15.0, -4.0, -2.0}, {19.0, -1.5, 1.0}},
                                         {{46.0, 2.0, -1.0}, {47.0, 4.0, 2.0}}};
  const auto places = distinctive_places({run_in_a_tube(0, kBlocks), run_in_a_tube(1, others, kFarAway)}, {});
  ASSERT_TRUE(places) << places.error().message;
  EXPECT_EQ((*places)[0][1], 0);
}

TEST(DistinctivePlaces, ATruthThatMissesAKeyframeNamesItsRobot) {
  RobotRun run = run_in_a_tube(0, {});
  run.truth.pop_back();
  EXPECT_ERROR(distinctive_places({run}, {}), "robot_0");
}

}  // namespace
}  // namespace adit

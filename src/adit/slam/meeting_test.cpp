// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/meeting.hpp"

#include <gtest/gtest.h>

#include "support/box_world.hpp"

namespace adit {
namespace {

TEST(Meeting, ARobotThatFailsInItsOwnMapStopsNoOther) {
  const test::BoxWorld world(11);
  std::vector<std::shared_ptr<const RobotMap>> maps;
  for (std::uint8_t id = 0; id < 3; ++id) {
    std::vector<Pose> truth;
    for (double x = 0.0; x < 16.0; x += 2.0) truth.push_back(Pose::planar(x, 0.3 * id, 0.0));
    RobotMap map = test::drive(world, {id}, truth, 0.0);
    if (id == 0) {  // its places are described in two ways
      map.scan_context.num_rings /= 2;
      map.places.back() = describe(*map.keyframes.back().cloud, map.scan_context);
    }
    maps.push_back(std::make_shared<const RobotMap>(std::move(map)));
  }
  SlamConfig config;
  config.loops.adaptive.search.revisit.path_m = 10.0;  // its last place is compared with its first one
  config.loops.adaptive.search.revisit.near_m = 20.0;
  const Result<Meeting> meeting = hold_meeting(maps, config);
  ASSERT_TRUE(meeting) << meeting.error().message;
  ASSERT_EQ(meeting->agents.size(), 3U);
  ASSERT_FALSE(meeting->failures.empty());
  EXPECT_TRUE(meeting->failures.front().starts_with("robot_0: ")) << meeting->failures.front();
  EXPECT_EQ(meeting->agents[1].known().robots.size(), 3U);
}

}  // namespace
}  // namespace adit

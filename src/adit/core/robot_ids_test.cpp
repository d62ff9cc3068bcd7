// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/robot_ids.hpp"

#include <gtest/gtest.h>

#include <set>

namespace adit {
namespace {

TEST(RobotIds, AreDistinctUpToTheLargestFleetAndRefusedBeyond) {
  const Result<std::vector<RobotId>> ids = robot_ids(kMaxRobots);
  ASSERT_TRUE(ids.has_value());
  EXPECT_EQ(std::set<RobotId>(ids->begin(), ids->end()).size(), kMaxRobots);
  EXPECT_EQ(ids->at(2), RobotId{2});
  for (const RobotId id : *ids) EXPECT_EQ(keyframe_id(graph_key({id, 7})).robot, id);
  const Result<std::vector<RobotId>> too_many = robot_ids(kMaxRobots + 1);
  ASSERT_FALSE(too_many.has_value());
  EXPECT_NE(too_many.error().message.find("257 recordings, and one fleet has at most 256 robots"),
            std::string::npos)
      << too_many.error().message;
}

}  // namespace
}  // namespace adit
